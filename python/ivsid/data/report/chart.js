"use strict";
// One panel: a uPlot with the colours of the page, a tube around a line, marked stretches, and flags where a spike is cut.
const Chart = (() => {
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const digits = (v) => (v == null ? "–" : String(Number(v.toPrecision(4))));
  // Logarithms are drawn as they are, and read as what they stand for.
  const read = (log) => (v) => (v == null ? "–" : log ? String(Number((10 ** v).toPrecision(3))) : digits(v));
  const DASH = { after: [7, 3], cause: [2, 3] };
  const WIDTH = { measured: 1.6 };

  // Samples that are in view, with one beside them on each side.
  const visible = (u) => {
    const [first, last] = u.series[0].idxs || [0, u.data[0].length - 1];
    return [Math.max(first - 1, 0), Math.min(last + 1, u.data[0].length - 1)];
  };

  const clipped = (u, draw) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    draw(ctx, bbox);
    ctx.restore();
  };

  const marks = (u, stretches) =>
    clipped(u, (ctx, box) => {
      ctx.fillStyle = colour("mark");
      for (const m of stretches) {
        const left = u.valToPos(m.start, "x", true);
        ctx.fillRect(left, box.top, u.valToPos(m.end, "x", true) - left, box.height);
      }
    });

  const tube = (u, row, half) =>
    clipped(u, (ctx) => {
      const [first, last] = visible(u);
      ctx.fillStyle = colour("tube");
      ctx.beginPath();
      for (const [from, to, by, side] of [[first, last, 1, half], [last, first, -1, -half]]) {
        for (let i = from; by > 0 ? i <= to : i >= to; i += by) {
          const v = u.data[row][i];
          if (v != null) ctx.lineTo(u.valToPos(u.data[0][i], "x", true), u.valToPos(v + side, "y", true));
        }
      }
      ctx.fill();
    });

  const cuts = (u, panel) => {
    const { min, max } = u.scales.y;
    const [first, last] = visible(u);
    const { ctx, bbox } = u;
    const size = 5 * devicePixelRatio;
    panel.lines.forEach((line, k) => {
      if (!u.series[k + 1].show) return;
      ctx.fillStyle = colour(line.role);
      let before = -size;
      for (let i = first; i <= last; i += 1) {
        const v = u.data[k + 1][i];
        const x = u.valToPos(u.data[0][i], "x", true);
        if (v == null || (v >= min && v <= max) || x - before < size || x < bbox.left || x > bbox.left + bbox.width) continue;
        before = x;
        const tip = v > max ? bbox.top : bbox.top + bbox.height;
        const foot = tip + (v > max ? size : -size);
        ctx.beginPath();
        ctx.moveTo(x, tip);
        ctx.lineTo(x - size / 2, foot);
        ctx.lineTo(x + size / 2, foot);
        ctx.fill();
      }
    });
  };

  // Spikes do not set the axis, unless nothing else is in view.
  const ends = (panel) => (u, low, high) => {
    if (low == null) return [0, 1];
    const reach = Math.max(0, ...panel.lines.map((q) => q.tube));
    let [a, b] = [low - reach, high + reach];
    if (panel.range && a < panel.range[1] && b > panel.range[0]) [a, b] = [Math.max(a, panel.range[0]), Math.min(b, panel.range[1])];
    const room = 0.05 * (b - a) || 0.05 * Math.abs(a) || 1;
    return [a - room, b + room];
  };

  return (host, group, panel, data, lowest) => {
    const axis = { stroke: () => colour("soft"), grid: { stroke: () => colour("rule"), width: 1 }, ticks: { stroke: () => colour("rule"), width: 1 }, font: "12px system-ui, sans-serif" };
    const lines = panel.lines.map((line) => ({
      label: line.label,
      stroke: () => colour(line.role),
      width: line.dots ? 0 : WIDTH[line.role] || 1.2,
      dash: line.dots ? [] : DASH[line.role],
      points: line.dots ? { show: true, size: 5, width: 1, fill: () => colour(line.role), stroke: () => colour(line.role) } : { show: false },
      paths: line.dots ? () => null : undefined,
      spanGaps: false,
      value: (_, v) => read(panel.log)(v),
    }));
    const across = group.across;
    const timed = across.label === "time [s]";
    const decades = (_, all) => all.map((v) => String(Number((10 ** v).toPrecision(2))));
    const place = timed ? (v) => (v == null ? "–" : v.toFixed(2)) : read(across.log);
    const tubes = panel.lines.map((line, k) => [line.tube, k + 1]).filter(([half]) => half > 0);
    return new uPlot(
      {
        width: Math.max(host.clientWidth, 200),
        // Curves have their detail upwards, logs have it along the clock.
        height: (lowest ? 186 : 166) + (timed ? 0 : 90),
        scales: { x: { time: false }, y: { range: ends(panel) } },
        series: [{ label: across.label, value: (_, v) => place(v) }, ...lines],
        axes: [
          { ...axis, size: lowest ? 48 : 30, label: lowest ? across.label : undefined, labelSize: 16, labelFont: axis.font, ...(across.log ? { values: decades } : {}) },
          { ...axis, size: panel.log ? 66 : 58, values: panel.log ? decades : (_, all) => all.map(digits) },
        ],
        legend: { markers: { width: 0, fill: (u, k) => u.series[k].stroke(u, k) } },
        cursor: { sync: { key: group.name }, drag: { x: true, y: false, setScale: true }, points: { size: 6 } },
        hooks: {
          drawClear: [(u) => marks(u, group.marks), (u) => tubes.forEach(([half, row]) => tube(u, row, half))],
          draw: [(u) => cuts(u, panel)],
          setScale: [(u, key) => key === "x" && group.follow(u)],
        },
      },
      data,
      host,
    );
  };
})();

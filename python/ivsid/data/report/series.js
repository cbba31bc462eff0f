"use strict";
// Figures of linked time series: one zoom and one cursor for all panels, by mouse, wheel, keys, buttons and links of the page.
(() => {
  const FACTOR = 1.6;
  const groups = new Map();

  class Group {
    constructor(figure) {
      this.figure = figure;
      this.name = figure.id;
      const held = JSON.parse(figure.querySelector("script").textContent);
      this.levels = new Levels(held.levels);
      this.marks = held.marks;
      this.panels = held.panels;
      this.across = held.across;
      this.level = this.levels.all[0];
      this.busy = false;
      this.plots = [];
      const host = figure.querySelector(".panels");
      held.panels.forEach((panel, k) => this.add(host, panel, k === held.panels.length - 1));
      new ResizeObserver(() => this.fit()).observe(host);
      figure.querySelector(".tools").addEventListener("click", (e) => this.act(e.target.dataset.do));
    }

    // Rows of a panel in a level: the panels hold their lines in order.
    rows(level, panel) {
      const first = this.panels.slice(0, this.panels.indexOf(panel)).reduce((n, p) => n + p.lines.length, 0);
      return [level.x, ...level.rows.slice(first, first + panel.lines.length)];
    }

    add(host, panel, lowest) {
      const box = document.createElement("div");
      box.className = "panel";
      box.tabIndex = 0;
      box.setAttribute("role", "group");
      box.setAttribute("aria-label", `${panel.title} against ${this.across.label}: ${panel.lines.map((q) => q.label).join(", ")}. Arrow keys move the cursor.`);
      const name = document.createElement("p");
      name.className = "name";
      name.textContent = panel.title;
      if (panel.cut) {
        const said = document.createElement("span");
        said.className = "cut";
        said.textContent = ` ▲ ${panel.cut} ${panel.cut === 1 ? "sample lies" : "samples lie"} beyond the axis; zoom in to see ${panel.cut === 1 ? "it" : "them"}`;
        name.append(said);
      }
      box.append(name);
      host.append(box);
      const plot = Chart(box, this, panel, this.rows(this.level, panel), lowest);
      box.addEventListener("keydown", (e) => this.key(e, plot));
      plot.over.addEventListener("mousedown", () => box.focus({ preventScroll: true }));
      plot.over.addEventListener("dblclick", () => this.act("whole"));
      plot.over.addEventListener("wheel", (e) => this.wheel(e, plot), { passive: false });
      this.plots.push(plot);
    }

    get view() {
      const { min, max } = this.plots[0].scales.x;
      return [min ?? this.levels.start, max ?? this.levels.end];
    }

    // Shows a stretch of time in every panel.
    show(start, end) {
      const least = Math.max(4 * (this.levels.at(start, end).x[1] - this.levels.at(start, end).x[0]), 1e-9);
      const span = Math.min(Math.max(end - start, least), this.levels.end - this.levels.start);
      const from = Math.min(Math.max(0.5 * (start + end - span), this.levels.start), this.levels.end - span);
      const level = this.levels.at(from, from + span);
      this.busy = true;
      this.plots.forEach((plot, k) =>
        plot.batch(() => {
          if (level !== this.level) plot.setData(this.rows(level, this.panels[k]), false);
          plot.setScale("x", { min: from, max: from + span });
        }),
      );
      this.level = level;
      this.busy = false;
      Object.assign(this.figure.dataset, { start: from, end: from + span });
    }

    // A drag in one panel zooms all.
    follow(plot) {
      if (this.busy || this.plots.length < this.panels.length) return;
      const { min, max } = plot.scales.x;
      if (min != null) queueMicrotask(() => this.show(min, max));
    }

    zoom(factor, centre) {
      const [a, b] = this.view;
      const at = centre ?? 0.5 * (a + b);
      this.show(at - (at - a) * factor, at + (b - at) * factor);
    }

    act(what) {
      const [a, b] = this.view;
      const step = 0.5 * (b - a);
      if (what === "whole") this.show(this.levels.start, this.levels.end);
      else if (what === "in") this.zoom(1 / FACTOR);
      else if (what === "out") this.zoom(FACTOR);
      else if (what === "left") this.show(a - step, b - step);
      else if (what === "right") this.show(a + step, b + step);
      else if (what === "csv") this.save();
    }

    wheel(e, plot) {
      // A page that is scrolled past a figure is not zoomed.
      if (!(e.ctrlKey || e.metaKey || this.figure.contains(document.activeElement))) return;
      e.preventDefault();
      this.zoom(e.deltaY < 0 ? 1 / FACTOR : FACTOR, plot.posToVal(e.clientX - plot.over.getBoundingClientRect().left, "x"));
    }

    key(e, plot) {
      const act = { "+": "in", "=": "in", "-": "out", 0: "whole", Home: "whole", PageUp: "left", PageDown: "right" }[e.key];
      const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
      if (act) this.act(act);
      else if (by) this.move(plot, by * (e.shiftKey ? 20 : 1));
      else return;
      e.preventDefault();
    }

    // Moves the cursor of all panels by samples, and the view with it.
    move(plot, by) {
      const { x } = this.level;
      const [a, b] = this.view;
      const held = plot.cursor.idx ?? x.findIndex((t) => t >= 0.5 * (a + b));
      const i = Math.min(Math.max(held + by, 0), x.length - 1);
      if (x[i] < a || x[i] > b) this.show(x[i] - 0.5 * (b - a), x[i] + 0.5 * (b - a));
      for (const p of this.plots) p.setCursor({ left: p.valToPos(x[i], "x"), top: 0.5 * p.over.clientHeight });
    }

    fit() {
      for (const plot of this.plots) {
        const width = plot.root.parentElement.clientWidth;
        if (width && width !== plot.width) plot.setSize({ width, height: plot.height });
      }
    }

    // What is in view, as a file.
    save() {
      const [a, b] = this.view;
      const { x, rows } = this.level;
      const quoted = (words) => `"${words.replaceAll('"', '""')}"`;
      const names = this.panels.flatMap((p) => p.lines.map((q) => quoted(`${p.title}: ${q.label}`)));
      const lines = [[this.across.label.includes(",") ? quoted(this.across.label) : this.across.label, ...names].join(",")];
      const logs = this.panels.flatMap((p) => p.lines.map(() => p.log));
      const meant = (v, log) => (log ? 10 ** v : v);
      // Samples at both ends belong to the view, however the ends are rounded.
      const slack = 1e-6 * (x[1] - x[0]);
      x.forEach((t, i) => {
        if (t >= a - slack && t <= b + slack) lines.push([Number(meant(t, this.across.log).toPrecision(12)), ...rows.map((r, k) => (r[i] == null ? "" : Number(meant(r[i], logs[k]).toPrecision(logs[k] ? 6 : 8))))].join(","));
      });
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([`${lines.join("\n")}\n`], { type: "text/csv" }));
      link.download = `${this.name}.csv`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    }
  }

  for (const figure of document.querySelectorAll("figure.series")) groups.set(figure.id, new Group(figure));

  // Links into the figures.
  document.addEventListener("click", (e) => {
    const link = e.target.closest("button[data-to]");
    const group = link && groups.get(link.dataset.to);
    if (!group) return;
    group.show(Number(link.dataset.start), Number(link.dataset.end));
    if (!group.figure.contains(link)) group.figure.scrollIntoView({ block: "start" });
    group.figure.querySelector(".panel").focus({ preventScroll: true });
  });

  // Other colours, and paper.
  document.addEventListener("theme", () => groups.forEach((g) => g.plots.forEach((p) => p.redraw(false))));
  document.addEventListener("paper", (e) => groups.forEach((g) => g.plots.forEach((p) => p.setSize({ width: e.detail || p.root.parentElement.clientWidth, height: p.height }))));
})();

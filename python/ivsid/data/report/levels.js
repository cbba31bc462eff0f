"use strict";
// Values of a figure at several levels of detail: the whole log, thinned where it is long, and a stretch sample by sample.
const Levels = (() => {
  const floats = (text) => {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
    // Files hold the least byte first, whatever the machine does.
    const view = new DataView(bytes.buffer);
    return Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  };

  const decoded = (level) => {
    const ticks = level.time ? floats(level.time) : null;
    const x = Float64Array.from({ length: level.count }, (_, i) => level.start + (ticks ? ticks[i] : i * level.step));
    // A missing value is a gap.
    const rows = level.values.map((text) => Array.from(floats(text), (v) => (Number.isNaN(v) ? null : v)));
    return { x, rows, bucket: level.bucket, start: x[0], end: x[x.length - 1] };
  };

  return class {
    constructor(levels) {
      this.all = levels.map(decoded);
      this.start = this.all[0].start;
      this.end = this.all[0].end;
    }

    // The finest level that holds a stretch of time.
    at(start, end) {
      return [...this.all].reverse().find((l) => l.start <= start && l.end >= end) || this.all[0];
    }
  };
})();

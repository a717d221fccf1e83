// Plots over the frames: gap and residuals, with the frame that is shown.
import {svg} from './parts.js';

const kWidth = 420, kHeight = 150, kLeft = 46, kRight = 8, kTop = 20,
      kBottom = 26;

// Round steps for an axis of about `count` labels.
function ticks(low, high, count) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= raw);
  const out = [];
  for (let t = Math.ceil(low / step) * step; t <= high + step / 1e6; t += step) {
    out.push(Number(t.toPrecision(12)));
  }
  return out;
}

// series: [{name, points: [[frame, value, u], ...]}]; drawn with bars of 2 u.
// lines: [{value, text}]: heights drawn across.
export class Plot {
  constructor(title, unit, onFrame) {
    this.title = title;
    this.unit = unit;
    this.cursor = svg('line', {class: 'cursor'});
    this.node = svg('svg', {class: 'plot', role: 'img',
                            viewBox: `0 0 ${kWidth} ${kHeight}`});
    this.node.addEventListener('click', event => {
      if (!this.range) return;
      const rect = this.node.getBoundingClientRect();
      const x = (event.clientX - rect.left) / rect.width * kWidth;
      const {from, to} = this.range;
      onFrame(Math.round(
          from + (x - kLeft) / (kWidth - kLeft - kRight) * (to - from)));
    });
  }

  show(series, frame, from, to, words, lines = []) {
    const all = series.flatMap(s => s.points).filter(
        p => p[0] >= from && p[0] <= to);
    this.node.setAttribute('aria-label', `${this.title}. ${words}`);
    if (all.length === 0) {
      this.range = null;
      this.node.replaceChildren(svg('text', {x: kLeft, y: 40, class: 'axis',
                                             text: `${this.title}: none`}));
      return;
    }
    let low = Math.min(0, ...all.map(p => p[1] - 2 * p[2]));
    let high = Math.max(0, ...all.map(p => p[1] + 2 * p[2]),
                        ...lines.map(line => line.value));
    const room = (high - low || 1) * 0.05;
    low -= room;
    high += room;
    this.range = {from, to};
    const x = f => kLeft + (f - from) / (to - from || 1) *
        (kWidth - kLeft - kRight);
    const y = v => kHeight - kBottom - (v - low) / (high - low) *
        (kHeight - kTop - kBottom);
    this.x = x;
    const parts = [svg('text', {x: 2, y: 12, class: 'axis',
                                text: `${this.title}, ${this.unit}`})];
    for (const t of ticks(low, high, 4)) {
      parts.push(svg('line', {x1: kLeft, x2: kWidth - kRight, y1: y(t), y2: y(t),
                              class: t === 0 ? 'zero' : 'grid'}),
                 svg('text', {x: kLeft - 5, y: y(t) + 4, class: 'axis end',
                              text: t}));
    }
    for (const t of ticks(from, to, 5)) {
      parts.push(svg('text', {x: x(t), y: kHeight - 8, class: 'axis middle',
                              text: t}));
    }
    for (const {value, text} of lines) {
      parts.push(svg('line', {x1: kLeft, x2: kWidth - kRight, y1: y(value),
                              y2: y(value), class: 'across'}),
                 svg('text', {x: kLeft + 4, y: y(value) - 3,
                              class: 'axis across', text}));
    }
    series.forEach(({name, points}) => {
      for (const [f, value, u] of points) {
        if (f < from || f > to) continue;
        parts.push(svg('line', {x1: x(f), x2: x(f), y1: y(value - 2 * u),
                                y2: y(value + 2 * u), class: `bar ${name}`}),
                   name === 'after'
                       ? svg('rect', {x: x(f) - 2.4, y: y(value) - 2.4,
                                      width: 4.8, height: 4.8,
                                      class: `dot ${name}`})
                       : svg('circle', {cx: x(f), cy: y(value), r: 2.4,
                                        class: `dot ${name}`}));
      }
    });
    this.node.replaceChildren(...parts, this.cursor);
    this.moveCursor(frame);
  }

  moveCursor(frame) {
    if (!this.range) return;
    const at = this.x(frame);
    for (const [name, value] of Object.entries(
             {x1: at, x2: at, y1: kTop - 4, y2: kHeight - kBottom})) {
      this.cursor.setAttribute(name, value);
    }
  }
}

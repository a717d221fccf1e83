// Pairs of points that a person marks on a picture: clicked, dragged, or moved
// by the arrow keys.
import {svg} from './parts.js';

// A click that moved farther was a pan.
const kClick_px = 4;

export class Marks {
  // `picture`: a Picture; `onChange(name)`: a pair was moved.
  constructor(picture, onChange) {
    this.picture = picture;
    this.onChange = onChange;
    this.pairs = new Map();  // name -> {label, points: [[x, y], [x, y]]}
    this.active = null;
    this.layer = svg('g', {class: 'marks'});
    picture.node.append(this.layer);
    // Lines and points keep their size on the screen, whatever the zoom.
    const draw = picture.draw.bind(picture);
    picture.draw = () => { draw(); this.draw(); };
    picture.node.addEventListener('pointerdown', event => {
      this.from = [event.clientX, event.clientY];
    }, {capture: true});
    picture.node.addEventListener('click', event => this.onClick(event));
  }

  // Both points are there at once, so that no mouse is needed: the next two
  // clicks put them where they belong.
  begin(name, label) {
    const {x, y, width, height} = this.picture.box;
    this.active = {name, clicks: 0};
    this.pairs.set(name, {label, points: [
      [x + 0.25 * width, y + 0.75 * height],
      [x + 0.75 * width, y + 0.75 * height]]});
    this.changed(name);
  }

  remove(name) {
    this.pairs.delete(name);
    if (this.active?.name === name) this.active = null;
    this.changed(name);
  }

  // [x1, y1, x2, y2], or null where the pair is not marked.
  of(name) {
    return this.pairs.get(name)?.points.flat().map(v => Number(v.toFixed(2))) ??
        null;
  }

  length(name) {
    const [x1, y1, x2, y2] = this.of(name);
    return Math.hypot(x2 - x1, y2 - y1);
  }

  changed(name) {
    this.draw();
    this.onChange(name);
  }

  onClick(event) {
    if (!this.active || event.target.closest('.mark')) return;
    const [x, y] = this.from ?? [event.clientX, event.clientY];
    if (Math.hypot(event.clientX - x, event.clientY - y) > kClick_px) return;
    const place = this.picture.place(event);
    const {points} = this.pairs.get(this.active.name);
    // Afterwards a click moves the nearer one.
    const distance = p => Math.hypot(p[0] - place.x, p[1] - place.y);
    const which = this.active.clicks < 2 ? this.active.clicks
        : distance(points[0]) <= distance(points[1]) ? 0 : 1;
    ++this.active.clicks;
    points[which] = [place.x, place.y];
    this.changed(this.active.name);
  }

  draw() {
    if (!this.layer) return;
    const focused = document.activeElement?.dataset?.mark;
    const r = 9 * this.picture.box.width / 1000;
    this.layer.replaceChildren();
    for (const [name, {label, points}] of this.pairs) {
      this.layer.append(svg('polyline', {
        points: points.map(p => p.join(',')).join(' '),
        class: `drawn mark-${name}`}));
      points.forEach((point, i) => this.layer.append(
          this.handle(name, label, points, i, r)));
    }
    if (focused) this.layer.querySelector(`[data-mark="${focused}"]`)?.focus();
  }

  handle(name, label, points, i, r) {
    const [x, y] = points[i];
    const handle = svg('circle', {
      cx: x, cy: y, r, class: `handle mark mark-${name}`, tabindex: '0',
      role: 'slider', 'data-mark': `${name}-${i}`,
      'aria-label': `${label}, point ${i + 1}: arrow keys move it`,
      'aria-valuenow': x.toFixed(1), 'aria-valuemin': '0',
      'aria-valuemax': String(this.picture.width),
      'aria-valuetext': `${x.toFixed(1)} px from the left, ${y.toFixed(1)} px ` +
          'from the top'});
    const put = (px, py) => {
      points[i] = [px, py];
      this.changed(name);
    };
    handle.addEventListener('pointerdown', event => {
      event.stopPropagation();
      handle.focus();
      this.picture.whileDown(event, moved => {
        const to = this.picture.place(moved);
        put(to.x, to.y);
      });
    });
    handle.addEventListener('keydown', event => {
      const step = event.shiftKey ? 10 : 0.5;
      const by = {ArrowUp: [0, -step], ArrowDown: [0, step],
                  ArrowLeft: [-step, 0], ArrowRight: [step, 0]}[event.key];
      if (!by) return;
      event.preventDefault();
      event.stopPropagation();
      put(points[i][0] + by[0], points[i][1] + by[1]);
    });
    return handle;
  }
}

// The recording with what was measured drawn over it: one SVG in the pixels of
// the recorded picture, so that zoom and drawing stay together.
import {svg} from './parts.js';

const kLeastZoom_px = 24;

export class Picture {
  // `onGround(p1, p2)`: the person moved the ground line.
  constructor(width, height, frameUrl, label, onGround) {
    this.width = width;
    this.height = height;
    this.frameUrl = frameUrl;
    this.onGround = onGround;
    this.editing = false;
    this.aspect = height / width;  // of the part that is shown
    this.mark_permille = 4;        // radius of the contact point, of its width
    this.frame = 0;
    this.view = null;
    // Pixel centres are at integers.
    this.image = svg('image', {x: -0.5, y: -0.5, width, height,
                               preserveAspectRatio: 'none'});
    this.drawing = svg('g', {class: 'drawing', 'aria-hidden': 'true'});
    this.handles = svg('g');
    this.node = svg('svg', {class: 'picture', role: 'group',
                            'aria-label': label},
                    this.image, this.drawing, this.handles);
    this.showAll();
    this.node.addEventListener('wheel', event => this.onWheel(event),
                               {passive: false});
    this.node.addEventListener('pointerdown', event => this.onPan(event));
  }

  setBox(x, y, width) {
    const height = width * this.aspect;
    this.box = {x, y, width, height};
    this.node.setAttribute('viewBox', `${x} ${y} ${width} ${height}`);
    // Enlarged pixels are shown as they are.
    this.image.classList.toggle('pixels', width < this.width / 2);
    this.draw();
  }

  showAll() { this.setBox(-0.5, -0.5, this.width); }

  zoom(factor, at = null) {
    const {x, y, width, height} = this.box;
    const centre = at ?? {x: x + width / 2, y: y + height / 2};
    const wide = Math.min(Math.max(width * factor, kLeastZoom_px),
                          this.width * 1.2);
    const share = wide / width;
    this.setBox(centre.x - (centre.x - x) * share,
                centre.y - (centre.y - y) * share, wide);
  }

  zoomTo(x, y, width) {
    const height = width * this.aspect;
    this.setBox(x - width / 2, y - height / 2, width);
  }

  // A pointer's place in the picture, px.
  place(event) {
    return new DOMPoint(event.clientX, event.clientY)
        .matrixTransform(this.node.getScreenCTM().inverse());
  }

  onWheel(event) {
    event.preventDefault();
    this.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.place(event));
  }

  onPan(event) {
    if (event.target.closest('.handle')) return;
    const from = this.place(event);
    const move = moved => {
      const to = this.place(moved);
      this.setBox(this.box.x + from.x - to.x, this.box.y + from.y - to.y,
                  this.box.width);
    };
    this.whileDown(event, move);
  }

  whileDown(event, move, done = () => {}) {
    this.node.setPointerCapture(event.pointerId);
    const end = () => {
      this.node.removeEventListener('pointermove', move);
      this.node.removeEventListener('pointerup', end);
      this.node.removeEventListener('pointercancel', end);
      done();
    };
    this.node.addEventListener('pointermove', move);
    this.node.addEventListener('pointerup', end);
    this.node.addEventListener('pointercancel', end);
  }

  // Resolves when the picture is on the screen.
  async showFrame(frame) {
    this.frame = frame;
    const plain = this.frameUrl(frame);
    // Of a camera that moved, the frame put back, as outlines and ground are.
    const steady = this.view?.steady;
    const url = steady
        ? `${plain}${plain.includes('?') ? '&' : '?'}steady=${steady}` : plain;
    this.image.setAttribute('href', url);
    this.node.dataset.frame = frame;
    this.draw();
    const loader = new Image();
    loader.src = url;
    await loader.decode().catch(() => {});
    if (this.frame === frame) this.node.dataset.shown = frame;
  }

  show(view, moved = {}, leftOut = new Set()) {
    this.view = view;
    this.moved = moved;
    this.leftOut = leftOut;
    this.draw();
  }

  draw() {
    const view = this.view;
    this.drawing.replaceChildren();
    if (!view || view.absent) {
      this.handles.replaceChildren();
      return;
    }
    // Lines of two pixels of the screen, whatever the zoom.
    const points = list => list.map(p => p.join(',')).join(' ');
    const line = (list, name) => this.drawing.append(
        svg('polyline', {points: points(list), class: `drawn ${name}`}));
    if (view.ground) line(view.ground.line_px, 'ground');
    line(view.poses.map(p => [p[1], p[2]]), 'path');
    for (const flight of view.flights ?? []) {
      line(flight.points_px, flight.which);
    }
    const pose = view.poses.find(p => p[0] === this.frame);
    if (pose) this.drawing.append(this.outline(view.body, pose));
    if (view.contact) {
      const [x, y] = view.contact.touching_px;
      const r = this.mark_permille * this.box.width / 1000;
      this.drawing.append(svg('circle', {cx: x, cy: y, r, class: 'touching'}));
      line(view.contact.approach_px, 'approach');
    }
    this.drawHandles();
  }

  outline(body, [, x, y, angle, size]) {
    const out = this.leftOut?.has(this.frame) ? ' left-out' : '';
    if (body.kind === 'sphere') {
      return svg('circle', {cx: x, cy: y, r: body.radius_px * size,
                            class: `drawn outline${out}`});
    }
    const a = body.half_long_px * size, b = body.half_short_px * size;
    return svg('rect', {x: -a, y: -b, width: 2 * a, height: 2 * b,
                        transform: `translate(${x} ${y}) rotate(${angle})`,
                        class: `drawn outline${out}`});
  }

  drawHandles() {
    const ground = this.view.ground;
    if (!this.editing || !ground) {
      this.handles.replaceChildren();
      return;
    }
    const focused = [...this.handles.children].indexOf(document.activeElement);
    const r = 11 * this.box.width / 1000;
    this.handles.replaceChildren(...['p1_px', 'p2_px'].map((name, i) => {
      const [x, y] = ground[name];
      const handle = svg('circle', {
        cx: x, cy: y, r, class: 'handle', tabindex: '0', role: 'slider',
        'aria-label': `ground line, ${i === 0 ? 'left' : 'right'} point: ` +
            'height in the picture, px',
        'aria-valuenow': y.toFixed(2), 'aria-valuemin': '0',
        'aria-valuemax': String(this.height),
        'aria-valuetext': `${y.toFixed(2)} px from the top`,
        'aria-orientation': 'vertical'});
      handle.addEventListener('pointerdown', event => {
        event.stopPropagation();
        handle.focus();
        this.whileDown(event, moved => {
          const to = this.place(moved);
          this.moveGround(name, to.x, to.y);
        });
      });
      handle.addEventListener('keydown', event => this.onHandleKey(event, name));
      return handle;
    }));
    if (focused >= 0) this.handles.children[focused].focus();
  }

  // Arrows: a tenth of a pixel; with Shift one.
  onHandleKey(event, name) {
    const step = event.shiftKey ? 1 : 0.1;
    const by = {ArrowUp: -step, ArrowDown: step}[event.key];
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    const [x, y] = this.view.ground[name];
    this.moveGround(name, x, y + by);
  }

  moveGround(name, x, y) {
    const ground = this.view.ground;
    const other = ground[name === 'p1_px' ? 'p2_px' : 'p1_px'];
    if (Math.abs(x - other[0]) < 2) return;  // two points on each other: no line
    ground[name] = [x, y];
    const [a, b] = [ground.p1_px, ground.p2_px];
    const slope = (b[1] - a[1]) / (b[0] - a[0]);
    ground.line_px = [0, this.width - 1].map(
        at => [at, a[1] + slope * (at - a[0])]);
    this.draw();
    this.onGround(a, b);
  }
}

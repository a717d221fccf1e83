// Two trials side by side, each at the same time from its touchdown.
import {said} from './numbers.js';
import {baseName, element, get, table} from './parts.js';
import {Picture} from './picture.js';
import {Playback} from './playback.js';
import {Plot} from './plots.js';

const kAround_ms = 40;  // beside touchdown that the plot shows
const kMarks = ['●', '■'];
const kSeries = ['before', 'after'];  // the plot's circles and squares

// One of the two: its picture, and the frame of a time from touchdown.
class Side {
  constructor(data, mark) {
    this.data = data;
    this.name = `${mark} ${baseName(data.row.clip.path) || data.row.id.slice(0, 8)}`;
    this.fps = data.view.fps ?? 0;
    this.frames = data.clip.absent === undefined ? data.clip.frames : 0;
    this.contact = data.numbers.frame;
    this.can = this.frames > 0 && this.contact !== null && this.fps > 0;
    if (!this.can) return;
    this.picture = new Picture(
        data.clip.width_px, data.clip.height_px,
        n => `/api/trials/${data.row.id}/frames/${n}`, this.name, () => {});
    this.picture.show(data.view);
    this.where = element('output', {class: 'muted'});
  }

  from_s() { return -Math.floor(this.contact) / this.fps; }
  to_s() { return (this.frames - 1 - Math.ceil(this.contact)) / this.fps; }

  go(time_s) {
    const frame = Math.min(Math.max(
        Math.round(this.contact + time_s * this.fps), 0), this.frames - 1);
    this.where.textContent = `frame ${frame} of ${this.frames}`;
    return this.picture.showFrame(frame);
  }

  node() {
    return element('section', {class: 'side'},
        element('h2', {}, element('a', {href: `#/trial/${this.data.row.id}`,
                                        text: this.name})),
        said(this.data.numbers), this.picture?.node ?? '',
        this.can ? this.where : element('p', {class: 'bad', text:
            this.data.clip.absent ?? 'It has no touchdown to be aligned at.'}));
  }

  gaps() {
    return (this.data.view.gaps ?? []).map(([frame, gap, u]) => [
      1000 * (frame - this.contact) / this.fps, gap, u]);
  }
}

function numbersOfBoth(sides) {
  const [a, b] = sides.map(side => side.data.numbers.quantities);
  const cell = q => q?.text ?? {text: q?.absent ?? '–', class: 'muted'};
  return table('Measured (± standard uncertainty)',
               ['number', ...sides.map(side => side.name)],
               a.map((q, i) => [q.words, cell(q), cell(b[i])]),
               {class: 'numbers'});
}

export async function compare(main, ...ids) {
  const sides = (await Promise.all(
      ids.slice(0, 2).map(id => get(`/api/trials/${id}`)))).map(
          (data, i) => new Side(data, kMarks[i]));
  const shown = element('div', {class: 'sides'}, ...sides.map(s => s.node()));
  const title = element('h1', {text: 'Side by side, from touchdown'});
  const numbers = element('div', {class: 'wide', tabindex: '0', role: 'region',
                                  'aria-label': 'Numbers of both'},
                          numbersOfBoth(sides));
  if (!sides.every(side => side.can)) {
    main.replaceChildren(title, shown, numbers);
    return {};
  }

  // Steps of the faster camera, as far as both were filmed.
  const step_s = 1 / Math.max(...sides.map(side => side.fps));
  const first = Math.ceil(Math.max(...sides.map(s => s.from_s())) / step_s);
  const last = Math.floor(Math.min(...sides.map(s => s.to_s())) / step_s);
  let at = 0;
  const slider = element('input', {
    type: 'range', id: 'scrub', min: first, max: last, value: 0,
    oninput: () => go(Number(slider.value))});
  const where = element('output', {id: 'frame', for: 'scrub'});
  const plot = new Plot('Gap', 'mm, over ms from touchdown',
                        ms => go(Math.round(ms / 1000 / step_s)));
  const series = sides.map((side, i) => ({name: kSeries[i],
                                          points: side.gaps()}));
  const seen_ms = series.flatMap(one => one.points.map(p => p[0]));
  plot.show(series, 0, Math.max(-kAround_ms, Math.min(...seen_ms)),
            Math.min(kAround_ms, Math.max(...seen_ms)),
            `Circles ${sides[0].name}, squares ${sides[1].name}`);

  function go(n) {
    at = Math.min(Math.max(n, first), last);
    slider.value = at;
    const ms = 1000 * at * step_s;
    where.textContent = `${ms < 0 ? '−' : '+'}${Math.abs(ms).toFixed(2)} ms`;
    plot.moveCursor(ms);
    return Promise.all(sides.map(side => side.go(at * step_s)));
  }

  const playback = new Playback({
    frames: last - first + 1, fps: 1 / step_s, contact: () => -first,
    frame: () => at - first, go: n => go(n + first)});
  main.replaceChildren(
      title, shown,
      element('div', {class: 'scrub'},
          element('label', {for: 'scrub', text: 'From touchdown'}), slider,
          where),
      element('div', {class: 'scrub'}, playback.node,
          element('button', {type: 'button', text: 'Touchdown (c)',
                             onclick: () => go(0)})),
      element('div', {class: 'plots'}, plot.node), numbers);
  await go(0);
  return {
    keys(event) {
      if (event.key === ' ' && event.target.closest?.('button, a')) return;
      const far = event.shiftKey ? 10 : 1;
      const act = {
        ArrowRight: () => go(at + far), ArrowLeft: () => go(at - far),
        Home: () => go(first), End: () => go(last), c: () => go(0),
        ' ': () => playback.toggle(), l: () => playback.toggleLoop(),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    },
    close() { playback.stop(); },
  };
}

// Playing a recording: all of it, slowly, or the frames beside the contact
// again and again.
import {element} from './parts.js';

const kAround = 12;  // frames to each side of the contact that the loop shows
const kRates_hz = [50, 25, 10, 5, 2];

// What a person chose last holds for the next trial, too.
const chosen = {rate_hz: 10, loops: false};

// "1/80 of real speed"
function share(rate_hz, fps) {
  const times = fps / rate_hz;
  return times >= 1.5 ? `1/${Math.round(times)} of real speed` : 'real speed';
}

export class Playback {
  // of: {frames, fps, frame(), contact(), go(n) -> promise}
  constructor(of) {
    this.of = of;
    this.running = null;
    this.toggleButton = element('button', {
      type: 'button', class: 'play', 'aria-keyshortcuts': 'Space',
      onclick: () => this.toggle()});
    this.rate = element('select', {
      'aria-label': 'speed', onchange: () => {
        chosen.rate_hz = Number(this.rate.value);
      }}, ...kRates_hz.map(hz => element('option', {
        value: hz, selected: hz === chosen.rate_hz,
        text: `${hz} frames/s` +
            (of.fps > 0 ? `, ${share(hz, of.fps)}` : '')})));
    this.loop = element('input', {
      type: 'checkbox', checked: chosen.loops,
      onchange: () => { chosen.loops = this.loop.checked; }});
    this.node = element('div', {class: 'playback'}, this.toggleButton,
        this.rate, element('label', {}, this.loop,
                           ' loop at the contact'));
    this.say();
  }

  say() {
    this.toggleButton.textContent = this.running ? '❚❚ Pause' : '▶ Play';
    this.node.dataset.playing = this.running !== null;
  }

  range() {
    const last = this.of.frames - 1;
    const contact = this.of.contact();
    if (!this.loop.checked || contact === null) return {from: 0, to: last};
    return {from: Math.max(0, contact - kAround),
            to: Math.min(last, contact + 1 + kAround)};
  }

  toggle() {
    if (this.running) this.stop();
    else this.play();
  }

  toggleLoop() {
    this.loop.checked = !this.loop.checked;
    chosen.loops = this.loop.checked;
  }

  stop() {
    this.running = null;
    this.say();
  }

  // A frame follows when its time has come and the one before it is there.
  async play() {
    const run = this.running = {};
    this.say();
    let next = this.of.frame() + 1;
    let {from, to} = this.range();
    if (next < from || next > to) next = from;  // from the end: begin again
    while (this.running === run) {
      const due = performance.now() + 1000 / Number(this.rate.value);
      await this.of.go(next);
      await new Promise(resolve => setTimeout(
          resolve, Math.max(0, due - performance.now())));
      next = this.of.frame() + 1;
      ({from, to} = this.range());
      if (next >= from && next <= to) continue;
      if (!this.loop.checked) break;
      next = from;
    }
    if (this.running === run) this.stop();
  }
}

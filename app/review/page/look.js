// How the picture looks: contrast and gamma, and what is drawn over it. Nothing
// measured depends on it.
import {element, svg} from './parts.js';

// Each part of the drawing with its name; the list is the legend, too.
export const kOverlays = [
  ['outline', 'outline of the body'],
  ['ground', 'ground line'],
  ['path', 'path of the centre'],
  ['before', 'flight before touchdown'],
  ['after', 'flight after it'],
  ['approach', 'contact, way of approach'],
];

// Held from trial to trial.
const chosen = {contrast: 1, gamma: 1, hidden: new Set()};

const kHalf = 0.5;  // contrast turns about mid grey

export class Look {
  // `root`: the pictures stand in it.
  constructor(root) {
    this.root = root;
    const func = () => ['R', 'G', 'B'].map(c => svg(`feFunc${c}`));
    this.gammaOf = func();
    this.contrastOf = func();
    this.filter = svg('svg', {class: 'filters', 'aria-hidden': 'true'},
        svg('filter', {id: 'look', x: 0, y: 0, width: 1, height: 1,
                       'color-interpolation-filters': 'sRGB'},
            svg('feComponentTransfer', {}, ...this.gammaOf),
            svg('feComponentTransfer', {}, ...this.contrastOf)));
    this.contrast = this.slider('contrast', 'Contrast', 0.5, 6);
    this.gamma = this.slider('gamma', 'Gamma', 0.3, 3);
    this.node = element('div', {class: 'appearance'}, this.filter,
        element('fieldset', {class: 'legend'},
            element('legend', {text: 'Drawn'}),
            ...kOverlays.map(([name, words]) => this.overlay(name, words))),
        element('fieldset', {},
            element('legend', {text: 'Picture'}),
            this.contrast.line, this.gamma.line,
            element('button', {type: 'button', text: 'As recorded',
                               onclick: () => this.reset()})));
    this.apply();
  }

  slider(name, words, least, most) {
    const input = element('input', {
      type: 'range', id: `look-${name}`, min: least, max: most, step: 0.1,
      value: chosen[name], oninput: () => {
        chosen[name] = Number(input.value);
        this.apply();
      }});
    return {input, line: element('p', {},
        element('label', {for: `look-${name}`, text: words}), ' ', input)};
  }

  overlay(name, words) {
    const box = element('input', {
      type: 'checkbox', value: name, checked: !chosen.hidden.has(name),
      onchange: () => {
        if (box.checked) chosen.hidden.delete(name);
        else chosen.hidden.add(name);
        this.apply();
      }});
    return element('label', {}, box,
        svg('svg', {class: 'swatch', viewBox: '0 0 24 8',
                    'aria-hidden': 'true'},
            svg('rect', {width: 24, height: 8, class: 'dark'}),
            svg('line', {x1: 1, x2: 23, y1: 4, y2: 4,
                         class: `drawn ${name}`})), words);
  }

  reset() {
    chosen.contrast = chosen.gamma = 1;
    this.contrast.input.value = this.gamma.input.value = 1;
    this.apply();
  }

  apply() {
    const slope = chosen.contrast;
    for (const f of this.gammaOf) {
      f.setAttribute('type', 'gamma');
      f.setAttribute('exponent', 1 / chosen.gamma);
    }
    for (const f of this.contrastOf) {
      f.setAttribute('type', 'linear');
      f.setAttribute('slope', slope);
      f.setAttribute('intercept', kHalf * (1 - slope));
    }
    // As recorded costs nothing.
    this.root.classList.toggle('filtered',
                               chosen.contrast !== 1 || chosen.gamma !== 1);
    for (const [name] of kOverlays) {
      this.root.classList.toggle(`no-${name}`, chosen.hidden.has(name));
    }
  }
}

// The part of a campaign's form that makes a lens.
import {element, post} from './parts.js';
import {clearTrouble, field, showTrouble} from './forms.js';

// A lens from a folder of board pictures: `calibration`, null where there is
// none.
export class LensPart {
  constructor(data) {
    const places = data.folders.flatMap((f, folder) => f.recordings
        .filter(r => r.is_folder).map(r => ({folder, name: r.name})));
    this.calibration = null;
    this.folder = element('select', {}, ...places.map((p, i) => element(
        'option', {value: i, text: p.name === '.' ? data.folders[p.folder].folder
                                                  : p.name})));
    this.places = places;
    this.board = element('input', {size: 20, autocomplete: 'off',
                                   placeholder: 'chessboard:9x6:25mm'});
    this.said = element('p', {class: 'hint', role: 'status'});
    this.make = element('button', {type: 'button', text: 'Make the lens',
                                   onclick: () => this.calibrate()});
    this.drop = element('button', {type: 'button', text: 'Without a lens',
                                   onclick: () => this.clear()});
    this.drop.hidden = true;
    this.node = element('details', {},
        element('summary', {text: 'A lens, from pictures of a board'}),
        places.length === 0
            ? element('p', {class: 'hint', text: 'Put ten or more pictures of ' +
                  'a board into a folder of their own, below the recordings.'})
            : element('div', {},
                  field('setup', 'pictures', 'Folder of pictures', this.folder),
                  field('setup', 'board', 'Board (inner corners, square)',
                        this.board),
                  element('div', {class: 'buttons'}, this.make, this.drop)),
        this.said);
  }

  clear() {
    this.calibration = null;
    this.drop.hidden = true;
    this.said.textContent = '';
  }

  async calibrate() {
    const form = this.node.closest('form');
    clearTrouble(form, this.said);
    this.said.className = 'hint';
    this.said.textContent = 'Looking for the board …';
    this.make.disabled = true;
    try {
      const lens = await post('/api/lens', {
        pictures: this.places[this.folder.value], board: this.board.value.trim(),
        camera: form.elements.camera.value.trim()});
      this.calibration = lens.calibration;
      this.drop.hidden = false;
      this.said.textContent = [
        `The lens bends up to ${lens.bends_px.toFixed(2)} px; ` +
            `${lens.rms_px.toFixed(3)} px rms over ${lens.views} pictures, ` +
            `${Math.round(100 * lens.coverage)} % of the picture covered.`,
        lens.without_board.length === 0 ? ''
            : `No whole board in ${lens.without_board.join(', ')}.`,
        ...lens.warnings].filter(Boolean).join(' ');
    } catch (error) {
      this.said.className = 'bad';
      this.said.textContent = '';
      showTrouble(form, error, this.said);
    }
    this.make.disabled = false;
  }
}

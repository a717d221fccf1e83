// What a person changes of a trial: drawn and worked out anew at once, stored
// with a reason as a revision.
import {draftOf, dropDraft, keepDraft} from './drafts.js';
import {element, post, Refused, table, tell, tellNext, who} from './parts.js';

const kStates = ['bounce', 'slide', 'roll-slide', 'roll', 'stick', 'stays-down',
                 'undecided'];
const kStep_px = 0.25;  // half of what a hand places an outline to

function empty() {
  return {ground_px: null, contact_frame: null, moved: {}, left_out: [],
          state: '', note: ''};
}

export class Correcting {
  // page: {id, data, frame(), preview(view), reset(), saved(revision)}
  constructor(page) {
    this.page = page;
    this.asked = empty();
    this.busy = false;
    this.again = false;
    this.stored = Promise.resolve();  // once nothing is being stored
    this.node = element('section', {class: 'correct', 'aria-label': 'Correct'});
    this.build();
  }

  build() {
    const button = (text, act, attributes = {}) =>
        element('button', {type: 'button', text, onclick: act, ...attributes});
    const has = this.page.data.view.absent === undefined;
    this.state = element('select', {id: 'state', onchange: () => this.changed()},
        element('option', {value: '', text: 'as judged'}),
        ...kStates.map(s => element('option', {value: s, text: s})));
    this.why = element('input', {id: 'why', size: 34,
                                 oninput: () => this.keep(),
                                 placeholder: 'what was wrong, and how you know'});
    this.draft = element('p', {class: 'draft', role: 'status'});
    this.result = element('div', {role: 'status', 'aria-live': 'polite'});
    this.trouble = element('p', {class: 'bad', role: 'alert'});
    this.save = button('Store this correction', () => this.store({}),
                       {class: 'main'});
    const move = (text, label, dx, dy) =>
        button(text, () => this.move(dx, dy), {'aria-label': label});
    const excluded = this.page.data.row.excluded;
    this.node.replaceChildren(
        element('h2', {text: 'Correct'}), this.draft,
        has ? element('div', {},
            element('p', {class: 'hint', text:
                'Ground line: drag its two points, or focus one and use the ' +
                'arrow keys (0.1 px; with Shift 1 px).'}),
            element('p', {},
                button('Touchdown is between this frame and the next (t)',
                       () => this.setContact())),
            element('p', {}, 'This outline, by 0.25 px: ',
                move('←', 'move the outline left', -kStep_px, 0),
                move('→', 'move the outline right', kStep_px, 0),
                move('↑', 'move the outline up', 0, -kStep_px),
                move('↓', 'move the outline down', 0, kStep_px),
                button('Leave it out', () => this.leaveOut())))
            : element('p', {class: 'hint',
                            text: 'Nothing to draw on: ' +
                                this.page.data.view.absent}),
        element('p', {},
            element('label', {for: 'state', text: 'Motion state '}), this.state),
        this.result,
        element('p', {},
            element('label', {for: 'why', text: 'Reason '}), this.why),
        this.trouble,
        element('p', {class: 'buttons'}, this.save,
            button('Start over', () => this.startOver()),
            button(excluded ? 'Include it again' : 'Exclude this trial',
                   () => this.store(excluded ? {include: true}
                                             : {exclude: true}))));
    this.showChanges([]);
  }

  // Whether something would be lost by going away.
  pending() {
    const a = this.asked;
    return a.ground_px !== null || a.contact_frame !== null ||
        Object.keys(a.moved).length > 0 || a.left_out.length > 0 ||
        this.state.value !== '' || this.why.value !== '';
  }

  // --- what was begun, from one visit to the next ----------------------------

  keep() {
    const {store_id, row, last_revision} = this.page.data;
    if (!this.pending()) {
      dropDraft(store_id, row.id);
      return;
    }
    keepDraft(store_id, row.id, {revision: last_revision, asked: this.asked,
                                 state: this.state.value, why: this.why.value});
  }

  // Called once the page shows the trial. A draft of the revision in force is
  // taken up; of another one the person is asked.
  takeUpDraft() {
    const {store_id, row, last_revision} = this.page.data;
    const draft = draftOf(store_id, row.id);
    if (draft === null) return;
    const button = (text, act) => element('button', {
      type: 'button', text, onclick: act});
    const away = button('Throw it away', () => this.startOver());
    const when = new Date(draft.at).toLocaleString();
    if (draft.revision === last_revision) {
      this.draft.replaceChildren(`Your draft of ${when} is back. `, away);
      this.use(draft);
      return;
    }
    this.draft.replaceChildren(
        `You began a correction of revision ${draft.revision} (${when}); ` +
        `revision ${last_revision} is in force now. `,
        button('Take it over', () => {
          this.draft.replaceChildren();
          this.use(draft);
        }), ' ', away);
  }

  use(draft) {
    this.asked = {...empty(), ...draft.asked};
    this.state.value = draft.state ?? '';
    this.why.value = draft.why ?? '';
    this.changed();
  }

  // --- changes ---------------------------------------------------------------

  setGround(p1, p2) {
    this.asked.ground_px = [...p1, ...p2];
    this.changed();
  }
  setContact() {
    this.asked.contact_frame = this.page.frame();
    this.changed();
  }
  move(dx, dy) {
    const frame = this.page.frame();
    const [x, y] = this.asked.moved[frame] ?? [0, 0];
    this.asked.moved[frame] = [x + dx, y + dy];
    this.changed();
  }
  leaveOut() {
    const frame = this.page.frame();
    if (!this.asked.left_out.includes(frame)) this.asked.left_out.push(frame);
    this.changed();
  }
  startOver() {
    this.asked = empty();
    this.state.value = '';
    this.why.value = '';
    this.trouble.textContent = '';
    this.draft.replaceChildren();
    this.keep();
    this.showChanges([]);
    this.page.reset();
  }

  body() { return {...this.asked, state: this.state.value}; }

  // One request at a time; the last change is always asked for.
  async changed() {
    this.trouble.textContent = '';
    this.keep();
    if (this.busy) {
      this.again = true;
      return;
    }
    this.busy = true;
    do {
      this.again = false;
      try {
        const said = await post(`/api/trials/${this.page.id}/preview`,
                                this.body());
        if (!this.again) {
          this.showChanges(said.changes);
          this.page.preview(said);
        }
      } catch (error) {
        if (!this.again) this.trouble.textContent = error.message;
      }
    } while (this.again);
    this.busy = false;
  }

  showChanges(changes) {
    this.result.replaceChildren(changes.length === 0
        ? element('p', {class: 'hint', text: 'Nothing is changed yet.'})
        : element('div', {class: 'changes', tabindex: '0', role: 'region',
                          'aria-label': 'What would change'},
                  table('What would change', ['number', 'from', 'to'],
                        changes.map(c => [c.words, c.from, c.to]))));
    this.result.dataset.changes = changes.length;
  }

  // Of a correction, or `instead` of it {exclude}, {include}, {restore}.
  store(instead) { return this.stored = this.send(instead); }

  async send(instead) {
    this.trouble.textContent = '';
    const {data, id} = this.page;
    const is_correction = Object.keys(instead).length === 0;
    try {
      const logged = await post(`/api/trials/${id}/revisions`, {
        ...(is_correction ? this.body() : instead),
        revision: data.last_revision, who: who(), why: this.why.value});
      // What else was begun waits for the person.
      this.why.value = '';
      if (is_correction || !this.pending()) dropDraft(data.store_id, id);
      tellNext(`Stored as revision ${logged.revision}. What was there before ` +
                   'is kept in the history. ',
               element('button', {type: 'button', text: 'Undo', onclick: () =>
                   this.undo(logged.revision, instead)}));
      await this.page.saved();
    } catch (error) {
      this.refused(error);
    }
  }

  // A further revision that takes the former values back; nothing is removed.
  async undo(revision, instead) {
    const {data, id} = this.page;
    let back = {restore: data.last_revision};
    if (instead.exclude) back = {include: true};
    if (instead.include) back = {exclude: true};
    const why = instead.include ? data.row.exclusion_reason
                                : `undo of revision ${revision}`;
    try {
      const logged = await post(`/api/trials/${id}/revisions`,
                                {...back, revision, who: who(), why});
      tellNext(`Undone: revision ${logged.revision} says again what was said ` +
               `before revision ${revision}.`);
      await this.page.saved();
    } catch (error) {
      tell(error.message, true);
    }
  }

  refused(error) {
    const problem = error instanceof Refused ? error.answer.problem : null;
    const field = {who: 'Your name (above)', why: 'The reason'}[
        error.answer?.field];
    this.trouble.textContent = field ? `${field} ${problem}` : error.message;
    if (error.answer?.field === 'who') document.getElementById('who').focus();
    if (error.answer?.field === 'why') this.why.focus();
    if (error.status === 409) {
      this.keep();  // whoever stored may have been another tab of this browser
      this.trouble.append(' ', element('button', {
        type: 'button', text: 'Show what is there now',
        onclick: () => this.page.saved()}));
    }
  }
}

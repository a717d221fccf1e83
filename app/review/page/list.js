// The list of trials: sorted and filtered as a person likes, two of them chosen
// to stand side by side.
import {draftOf} from './drafts.js';
import {keepOrder} from './order.js';
import {baseName, degrees, element, table, withU} from './parts.js';
import {watchThumbnail} from './thumbnails.js';

// The shape says it as well as the colour does.
const kStateMarks = {bounce: '▲', undecided: '?'};

function stateCell(state) {
  const shade = state === 'bounce' || state === 'undecided' ? state : 'slide';
  return {text: `${kStateMarks[state] ?? '▬'} ${state}`, class: shade};
}

const nameOf = t => baseName(t.clip.path) || t.id.slice(0, 8);
const dateOf = t => t.recorded_at_utc.slice(0, 16).replace('T', ' ');

// What a column is sorted by; of equal ones the server's order stays.
const kColumns = [
  {key: 'name', text: 'trial', by: t => nameOf(t).toLowerCase()},
  {key: 'need', text: 'needs a look', by: null},  // the server's order
  {key: 'campaign', text: 'campaign', by: t => t.campaign},
  {key: 'date', text: 'revised, UTC', by: t => t.recorded_at_utc},
  {key: 'set', text: 'set, deg', class: 'num', by: t => t.set_angle_deg},
  {key: 'angle', text: 'angle, deg', class: 'num',
   by: t => t.angle_deg?.value ?? null},
  {key: 'state', text: 'state', by: t => t.state},
  {key: 'origin', text: 'origin', by: t => t.origin},
];

const kFilters = {campaign: t => t.campaign || '–', state: t => t.state,
                  origin: t => t.origin};

// Held while the page is open: who comes back from a trial finds the list again.
const chosen = {sort: 'need', down: false, words: '', look: false,
                compare: new Set(),
                ...Object.fromEntries(Object.keys(kFilters).map(k => [k, '']))};

function sorted(trials) {
  const column = kColumns.find(c => c.key === chosen.sort);
  const out = [...trials];
  if (column.by) {
    // What is absent stands last, whichever way.
    const sign = chosen.down ? -1 : 1;
    out.sort((a, b) => {
      const [x, y] = [column.by(a), column.by(b)];
      if (x === null || y === null) return (x === null) - (y === null);
      return x < y ? -sign : x > y ? sign : 0;
    });
  } else if (chosen.down) {
    out.reverse();
  }
  return out;
}

export class TrialList {
  constructor() {
    this.trials = [];
    this.words = element('input', {
      type: 'search', id: 'filter', placeholder: 'name, campaign, state …',
      value: chosen.words, oninput: () => {
        chosen.words = this.words.value;
        this.filter();
      }});
    this.selects = Object.keys(kFilters).map(key => element('select', {
      'aria-label': key, 'data-filter': key, onchange: event => {
        chosen[key] = event.target.value;
        this.filter();
      }}));
    this.look = element('input', {
      type: 'checkbox', checked: chosen.look, onchange: () => {
        chosen.look = this.look.checked;
        this.filter();
      }});
    this.count = element('span', {role: 'status'});
    this.beside = element('span', {class: 'compare'});
    this.node = element('div', {},
        element('p', {class: 'tools'},
            element('label', {for: 'filter', text: 'Show only '}), this.words,
            ...this.selects,
            element('label', {}, this.look, ' to look at'),
            this.count, this.beside),
        this.list = element('div', {class: 'list', tabindex: '0',
                                    role: 'region', 'aria-label': 'Trials'}));
  }

  show(trials, store_id) {
    this.trials = trials;
    this.store_id = store_id;
    this.selects.forEach(select => {
      const key = select.dataset.filter;
      const values = [...new Set(trials.map(kFilters[key]))].sort();
      if (!values.includes(chosen[key])) chosen[key] = '';
      select.replaceChildren(
          element('option', {value: '', text: `any ${key}`}),
          ...values.map(v => element('option', {
            value: v, text: v, selected: v === chosen[key]})));
    });
    this.draw();
  }

  draw() {
    const focused = document.activeElement?.closest?.('tr')?.dataset.id;
    const trials = sorted(this.trials);
    const made = table('Trials', ['', ...kColumns.map(c => this.heading(c))],
                       trials.map(t => this.row(t)), {class: 'trials'});
    made.querySelectorAll('th').forEach((th, i) => {
      const column = kColumns[i - 1];
      th.className = column?.class ?? '';
      if (!column) {
        th.append(element('span', {class: 'hidden', text: 'compare'}));
      } else if (column.key === chosen.sort) {
        th.setAttribute('aria-sort', chosen.down ? 'descending' : 'ascending');
      }
    });
    this.rows = [...made.querySelectorAll('tbody tr')];
    this.rows.forEach((row, i) => {
      row.dataset.id = trials[i].id;
      row.trial = trials[i];
      if (trials[i].excluded) row.classList.add('excluded');
    });
    this.list.replaceChildren(made);
    this.filter();
    this.sayChosen();
    if (focused) {
      this.list.querySelector(`tr[data-id="${focused}"] a`)?.focus();
    }
  }

  heading(column) {
    const arrow = column.key !== chosen.sort ? '' : chosen.down ? ' ▼' : ' ▲';
    return element('button', {
      type: 'button', class: 'sort', text: column.text + arrow,
      onclick: () => {
        chosen.down = column.key === chosen.sort && !chosen.down;
        chosen.sort = column.key;
        this.draw();
        this.list.querySelectorAll('.sort')[kColumns.indexOf(column)].focus();
      }});
  }

  row(trial) {
    const name = nameOf(trial);
    const image = trial.clip.path ? element('img', {
      class: 'thumbnail', alt: '', width: 64, height: 48,
      'data-src': `/api/trials/${trial.id}/thumbnail?${trial.revision}`}) : '';
    if (image) watchThumbnail(image);
    const why = trial.excluded ? `excluded: ${trial.exclusion_reason}`
                               : trial.why;
    return [
      element('input', {
        type: 'checkbox', 'aria-label': `compare ${name}`,
        checked: chosen.compare.has(trial.id), onchange: event => {
          if (event.target.checked) chosen.compare.add(trial.id);
          else chosen.compare.delete(trial.id);
          this.sayChosen();
        }}),
      element('a', {class: 'name', href: `#/trial/${trial.id}`}, image,
              element('span', {text: name, title: trial.clip.path})),
      element('div', {class: 'why'},
          trial.attention ? element('strong', {class: 'look',
                                               text: trial.attention}) : '',
          why ? ` ${why}` : '',
          draftOf(this.store_id, trial.id) === null ? '' :
              element('em', {text: ' a correction was begun'})),
      trial.campaign || '–',
      dateOf(trial),
      {text: degrees(trial.set_angle_deg), class: 'num'},
      {text: `${withU(trial.angle_deg)} ${trial.angle_kind}`, class: 'num'},
      stateCell(trial.state),
      trial.origin,
    ];
  }

  filter() {
    const words = chosen.words.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = [];
    for (const row of this.rows ?? []) {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every(word => text.includes(word)) ||
          chosen.look && !row.trial.attention ||
          Object.entries(kFilters).some(
              ([key, of]) => chosen[key] && of(row.trial) !== chosen[key]);
      if (!row.hidden) kept.push(row.dataset.id);
    }
    keepOrder(kept);
    this.count.textContent = `${kept.length} of ${this.rows?.length ?? 0}`;
  }

  sayChosen() {
    const ids = [...chosen.compare].filter(
        id => this.trials.some(t => t.id === id));
    this.beside.replaceChildren(
        ids.length === 0 ? ''
        : ids.length === 2 ? element('a', {
            href: `#/compare/${ids.join('/')}`, text: 'Show these two side by side'})
        : `side by side: ${ids.length} chosen, two can be shown`);
  }

  // Up and down go from trial to trial.
  move(event) {
    if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
    const links = [...this.list.querySelectorAll('tbody a')].filter(
        link => link.offsetParent !== null);
    const at = links.indexOf(document.activeElement);
    const next = links[at + (event.key === 'ArrowDown' ? 1 : -1)] ?? links[0];
    next?.focus();
    event.preventDefault();
  }
}

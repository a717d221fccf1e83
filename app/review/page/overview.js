// Campaigns, what the trials say together, and the trials that need a look.
import {baseName, degrees, element, get, table, tell, withU} from './parts.js';

function campaignTable(campaigns) {
  return table(
      'Campaigns',
      ['name', 'body', 'surface', 'angle', 'declared theory',
       {text: 'trials', class: 'num'}],
      campaigns.map(c => [c.name, c.body, c.surface || '–', c.angle_kind,
                          c.theory || 'none',
                          {text: c.trials, class: 'num'}]));
}

function nextText(group) {
  const next = group.next;
  if (next.stop === 'target-reached') {
    return `${group.sentences.next} The target is reached.`;
  }
  if (next.stop === 'max-trials') {
    return `${group.sentences.next} As many trials as planned are thrown.`;
  }
  return `${group.sentences.next} About ${next.trials_to_target} more trials.`;
}

function leftOut(group) {
  if (group.left_out.length === 0) return null;
  return element('details', {},
      element('summary', {text: `${group.left_out.length} left out`}),
      element('ul', {}, ...group.left_out.map(
          left => element('li', {}, element('a', {
            href: `#/trial/${left.trial}`, text: left.name}),
            `: ${left.reason}`))));
}

function groupCard(group, number, stamp) {
  return element(
      'section', {class: group.simulated ? 'card simulated' : 'card'},
      element('h3', {text: group.name}),
      group.simulated
          ? element('p', {class: 'banner',
              text: 'SIMULATED: no verdict on a theory rests on these'})
          : null,
      element('dl', {},
              element('dt', {text: 'Next angle'}),
              element('dd', {class: 'next', text: nextText(group)}),
              element('dt', {text: 'Boundary'}),
              element('dd', {text: group.sentences.boundary}),
              element('dt', {text: 'Verdict'}),
              element('dd', {text: group.sentences.verdict + ': ' +
                                   group.sentences.verdict_reason})),
      leftOut(group),
      element('figure', {},
              element('img', {src: `/api/plots/${number}?${stamp}`,
                              alt: group.plot.alt, loading: 'lazy'}),
              element('figcaption', {text: group.plot.caption})));
}

function table1(tables) {
  return tables.map(
      t => table(t.caption,
                 t.columns.map(c => ({text: c.heading,
                                      class: c.numeric ? 'num' : null})),
                 t.rows.map(row => row.map((c, i) => ({
                   text: c.text,
                   class: `${c.tone}${t.columns[i]?.numeric ? ' num' : ''}`,
                 }))),
                 {class: t.origin === 'simulated' ? 'simulated' : null}));
}

// The shape says it as well as the colour does.
const kStateMarks = {bounce: '▲', undecided: '?'};

function trialRow(trial) {
  const mark = kStateMarks[trial.state] ?? '▬';
  const shade = trial.state === 'bounce' || trial.state === 'undecided'
      ? trial.state : 'slide';
  return [
    element('a', {href: `#/trial/${trial.id}`,
                  text: baseName(trial.clip.path) || trial.id.slice(0, 8)}),
    {text: trial.attention ?? '', class: trial.attention ? 'look' : null},
    {text: trial.excluded ? `excluded: ${trial.exclusion_reason}` : trial.why,
     class: 'why'},
    trial.campaign || '–',
    trial.origin,
    {text: `${withU(trial.angle_deg)}`, class: 'num'},
    trial.angle_kind,
    {text: `${mark} ${trial.state}`, class: shade},
    {text: trial.revision, class: 'num'},
  ];
}

function trialTable(trials) {
  const headings = [
    'trial', 'needs a look', 'why', 'campaign', 'origin',
    {text: 'angle, deg', class: 'num'}, 'kind', 'state',
    {text: 'revision', class: 'num'}];
  const made = table('Trials, those that need a look first', headings,
                     trials.map(trialRow), {class: 'trials'});
  made.querySelectorAll('tbody tr').forEach((row, i) => {
    row.dataset.id = trials[i].id;
    if (trials[i].excluded) row.classList.add('excluded');
  });
  return made;
}

// Up and down go from trial to trial.
function moveInList(event, list) {
  if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
  const links = [...list.querySelectorAll('tbody a')].filter(
      link => link.offsetParent !== null);
  const at = links.indexOf(document.activeElement);
  const next = links[at + (event.key === 'ArrowDown' ? 1 : -1)] ?? links[0];
  next?.focus();
  event.preventDefault();
}

export async function overview(main) {
  const list = element('div', {class: 'list'});
  const said = element('div', {class: 'together'},
                       element('p', {text: 'Working out the boundary …'}));
  const campaigns = element('div');
  const filter = element('input', {
    type: 'search', id: 'filter', placeholder: 'name, campaign, state …'});
  const count = element('span', {role: 'status'});

  function applyFilter() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    let visible = 0;
    const rows = list.querySelectorAll('tbody tr');
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every(word => text.includes(word));
      visible += row.hidden ? 0 : 1;
    }
    count.textContent = `${visible} of ${rows.length}`;
  }
  filter.addEventListener('input', applyFilter);

  async function load() {
    const trials = await get('/api/trials');
    // Nothing to look at yet: the first campaign is made.
    if (trials.campaigns.length === 0 && trials.trials.length === 0) {
      location.replace('#/setup');
      return null;
    }
    campaigns.replaceChildren(campaignTable(trials.campaigns));
    const focused = document.activeElement?.closest?.('tr')?.dataset.id;
    list.replaceChildren(trialTable(trials.trials));
    applyFilter();
    if (focused) {
      list.querySelector(`tr[data-id="${focused}"] a`)?.focus();
    }
    heading.textContent = trials.to_look_at
        ? `Trials: ${trials.to_look_at} of ${trials.trials.length} to look at`
        : `Trials: ${trials.trials.length}, none to look at`;
    return trials.stamp;
  }

  async function loadStatistics(stamp) {
    try {
      const s = await get('/api/statistics');
      said.replaceChildren(
          element('div', {class: 'cards'},
                  ...s.groups.map((g, i) => groupCard(g, i, stamp)),
                  ...s.without_trials.map(
                      c => element('section', {class: 'card'},
                                   element('h3', {text: c.campaign}),
                                   element('p', {class: 'next', text:
                      `No trial yet. Begin at ${c.angle_kind} angle ` +
                      c.next}))),
                  ...s.check_shots.map(
                      c => element('section', {class: 'card'},
                                   element('h3', {text: c.campaign}),
                                   element('p', {text: `Speed: ${c.speed}`}),
                                   element('p', {text:
                      `Approach angle: ${c.angle}`})))),
          element('h2', {text: 'Table 1 as it stands'}),
          element('div', {class: 'wide', tabindex: '0', role: 'region',
                          'aria-label': 'Table 1'}, ...table1(s.table1)));
    } catch (error) {
      said.replaceChildren(
          element('p', {class: 'bad', role: 'alert', text: error.message}));
    }
  }

  const heading = element('h1', {text: 'Trials'});
  main.replaceChildren(
      heading,
      element('p', {class: 'tools'},
              element('label', {for: 'filter', text: 'Show only '}), filter,
              ' ', count),
      list, element('h2', {text: 'What they say together'}), said, campaigns);
  const first = await load();
  if (first === null) return {};
  loadStatistics(first);
  return {
    async changed() {
      const stamp = await load();
      tell('The store has changed; this is what it says now.');
      await loadStatistics(stamp);
    },
    keys(event) { moveInList(event, list); },
  };
}

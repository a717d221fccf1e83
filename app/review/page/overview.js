// Campaigns, what the trials say together, and the trials that need a look.
import {TrialList} from './list.js';
import {element, get, table, tell} from './parts.js';

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

export async function overview(main) {
  const list = new TrialList();
  const said = element('div', {class: 'together'},
                       element('p', {text: 'Working out the boundary …'}));
  const campaigns = element('div', {class: 'wide', tabindex: '0', role: 'region',
                                    'aria-label': 'Campaigns'});

  async function load() {
    const trials = await get('/api/trials');
    // Nothing to look at yet: the first campaign is made.
    if (trials.campaigns.length === 0 && trials.trials.length === 0) {
      location.replace('#/setup');
      return null;
    }
    campaigns.replaceChildren(campaignTable(trials.campaigns));
    list.show(trials.trials, trials.store_id);
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
      list.node, element('h2', {text: 'What they say together'}), said, campaigns);
  const first = await load();
  if (first === null) return {};
  loadStatistics(first);
  return {
    async changed() {
      await loadStatistics(await load());
      return () => tell('The store has changed; this is what it says now.');
    },
    keys(event) { list.move(event); },
  };
}

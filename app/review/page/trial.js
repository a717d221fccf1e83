// One trial: pictures, plots, numbers, history, correction.
import {Correcting} from './correct.js';
import {baseName, element, get, table, tell} from './parts.js';
import {Picture} from './picture.js';
import {Plot} from './plots.js';

const kAround = 40;  // frames beside the contact that the plots show

function numbersTable(numbers) {
  const rows = numbers.quantities.map(
      q => [q.name, q.text ?? {text: q.absent, class: 'muted'}]);
  return table('Measured (± standard uncertainty)', ['number', 'value'], rows,
               {class: 'numbers'});
}

const kConditions = {
  person: 'operator', temperature_c: 'air, °C',
  relative_humidity: 'relative humidity, 0 to 1',
  elevation_deg: 'elevation, deg', compression_mm: 'compression, mm',
  muzzle_height_mm: 'muzzle height, mm', note: "operator's note",
  anomaly_note: 'what it was',
};

function conditionsTable(conditions) {
  if (conditions.length === 0) return null;
  return table('As it was set', ['what', 'value'], conditions.map(
      c => [kConditions[c.name] ?? c.name, c.text]), {class: 'numbers'});
}

function budget(name, lines) {
  if (lines.length === 0) return null;
  return table(`Where the uncertainty of the ${name} comes from`,
               ['source', {text: 'u, deg', class: 'num'}],
               lines.map(l => [l.source,
                               {text: l.u_deg.toFixed(4), class: 'num'}]));
}

function said(numbers) {
  const p = numbers.p_bounce === null ? '' :
      `, P(bounce) ${numbers.p_bounce.toFixed(4)}`;
  return element('dl', {class: 'said'},
      element('dt', {text: `${numbers.angle_kind} angle`}),
      element('dd', {class: 'angle', text: numbers.angle}),
      element('dt', {text: 'state'}),
      element('dd', {class: 'state', text: numbers.state + p}),
      element('dt', {text: 'because'}),
      element('dd', {text: numbers.state_reason || numbers.reason || '–'}));
}

function historyList(history, shown, last, id, restore) {
  return element('ol', {class: 'history', reversed: true},
      ...[...history].reverse().map(h => element('li', {value: h.revision},
          h.revision === shown
              ? element('strong', {text: `revision ${h.revision} (shown)`})
              : element('a', {href: `#/trial/${id}/${h.revision}`,
                              text: `revision ${h.revision}`}),
          ` ${h.kind} by ${h.who}, ${h.when.slice(0, 19).replace('T', ' ')}` +
          ` UTC${h.why ? ': ' + h.why : ''}`,
          h.revision !== last && h.revision === shown
              ? element('button', {type: 'button', text:
                  'State this again', onclick: () => restore(h.revision)})
              : null,
          h.changes.length === 0 ? null
              : element('details', {},
                    element('summary', {text: `what changed: ` +
                        h.changes.slice(0, 3).map(c => c.field).join(', ') +
                        (h.changes.length > 3 ? ' …' : '')}),
                    element('ul', {}, ...h.changes.map(c => element('li', {text:
                        `${c.field}: ${c.from} → ${c.to}`})))))));
}

// An analysis that waits for a person; a person's correction stays in force.
function proposalNote(data) {
  if (data.proposal === null) return '';
  const shown = data.row.revision === data.proposal;
  const changes = data.history.find(h => h.revision === data.proposal).changes;
  return element('div', {class: 'proposal'},
      element('p', {},
          shown ? 'This is an analysis that was proposed; the correction by a ' +
                  'person stays in force. "State this again" accepts it.'
                : 'A new analysis differs from this correction: ',
          shown ? '' : element('a', {
            href: `#/trial/${data.row.id}/${data.proposal}`,
            text: `look at revision ${data.proposal} and accept it there`})),
      element('ul', {}, ...changes.slice(0, 6).map(c => element('li', {text:
          `${c.field}: ${c.from} → ${c.to}`}))));
}

export async function trial(main, id, revision) {
  const path = `/api/trials/${id}${revision ? `?revision=${revision}` : ''}`;
  let data = await get(path);
  const old = data.row.revision !== data.last_revision;
  const clip = data.clip;
  const frames = clip.absent === undefined ? clip.frames : 0;
  const contact = () => data.numbers.frame === null
      ? null : Math.floor(data.numbers.frame);
  let frame = Math.min(Math.max(contact() ?? 0, 0), Math.max(frames - 1, 0));
  let view = data.view;

  const picture = frames === 0 ? null : new Picture(
      clip.width_px, clip.height_px, n => `/api/trials/${data.row.id}/frames/${n}`,
      'The recording with what was measured drawn over it',
      (p1, p2) => correcting.setGround(p1, p2));
  const gaps = new Plot('Gap', '', n => go(n));
  const residuals = new Plot('Height minus the fitted flights', '', n => go(n));
  const slider = element('input', {
    type: 'range', min: 0, max: Math.max(frames - 1, 0), value: frame,
    id: 'scrub', oninput: () => go(Number(slider.value))});
  const where = element('output', {id: 'frame', for: 'scrub'});
  const summary = element('div');
  const details = element('div');

  function show(frameNow) {
    const has = view.absent === undefined;
    const around = contact();
    const first = has ? view.poses[0]?.[0] ?? 0 : 0;
    const last = has ? view.poses[view.poses.length - 1]?.[0] ?? 0 : 0;
    const from = Math.max(first, around === null ? first : around - kAround);
    const to = Math.min(last, around === null ? last : around + kAround);
    gaps.unit = residuals.unit = view.length_unit ?? 'px';
    gaps.show(has && view.gaps ? [{name: 'before', points: view.gaps}] : [],
              frameNow, from, to,
              `Height of the lowest point of the body above the ground, frames ` +
              `${from} to ${to}; ${data.numbers.state}`);
    const of = name => (view.residuals ?? []).filter(r => r[1] === name).map(
        r => [r[0], r[4], r[5]]);
    residuals.show(has ? [{name: 'before', points: of('before')},
                          {name: 'after', points: of('after')}] : [],
                   frameNow, from, to,
                   'Circles before touchdown, squares after it; bars are two ' +
                   'standard uncertainties');
    picture?.show(view, correcting.asked.moved,
                  new Set(correcting.asked.left_out));
  }

  function go(n) {
    if (frames === 0) return;
    frame = Math.min(Math.max(n, 0), frames - 1);
    slider.value = frame;
    where.textContent = `frame ${frame} of ${frames}`;
    gaps.moveCursor(frame);
    residuals.moveCursor(frame);
    return picture.showFrame(frame);
  }

  function describe(numbers) {
    summary.replaceChildren(said(numbers));
    details.replaceChildren(
        numbersTable(numbers),
        conditionsTable(numbers.conditions) ?? '',
        budget('approach angle', numbers.approach_budget) ?? '',
        budget('radius and face angle', numbers.attitude_budget) ?? '');
  }

  const page = {
    id: data.row.id,
    get data() { return data; },
    frame: () => frame,
    preview(news) {
      view = news.view;
      describe(news.numbers);
      show(frame);
    },
    reset() {
      view = structuredClone(data.view);
      describe(data.numbers);
      show(frame);
    },
    // The trial has a new revision: look at that.
    async saved() {
      const hash = `#/trial/${data.row.id}`;
      if (location.hash === hash) dispatchEvent(new HashChangeEvent('hashchange'));
      else location.hash = hash;
    },
  };
  const correcting = new Correcting(page);

  function zoomToContact() {
    const at = view.contact?.centre_px ??
        view.poses?.find(p => p[0] === frame)?.slice(1, 3);
    if (!at || !picture) return;
    const body = view.body;
    const size = body.kind === 'sphere' ? 2 * body.radius_px
                                        : 2 * body.half_long_px;
    picture.zoomTo(at[0], at[1], Math.max(24, size * 2.5));
  }

  const button = (text, act, label) => element(
      'button', {type: 'button', text, onclick: act, 'aria-label': label});
  const warnings = [...(view.warnings ?? []), ...(view.refuted ? [view.refuted]
                                                                : [])];
  main.replaceChildren(
      element('h1', {text: baseName(data.row.clip.path) || 'Trial by hand'}),
      element('p', {class: 'under'},
          `${data.row.campaign || 'no campaign'} · ${data.row.origin} · ` +
          `revision ${data.row.revision} of ${data.history.length}`,
          data.row.excluded ? element('strong', {class: 'bad', text:
              ` · EXCLUDED: ${data.row.exclusion_reason}`}) : '',
          data.simulated ? element('strong', {class: 'bad',
              text: ' · SIMULATED: no verdict on a theory rests on it'}) : '',
          old ? element('strong', {}, ' · not the revision in force; ',
                        element('a', {href: `#/trial/${data.row.id}`,
                                      text: 'show that one'})) : ''),
      element('div', {class: 'trial'},
          element('div', {class: 'see'},
              picture?.node ?? element('p', {class: 'bad', text:
                  `No pictures: ${clip.absent}`}),
              frames === 0 ? '' : element('div', {class: 'scrub'},
                  element('label', {for: 'scrub', text: 'Frame'}), slider, where,
                  button('c', () => go(contact() ?? frame), 'to the contact'),
                  button('+', () => picture.zoom(0.7), 'zoom in'),
                  button('−', () => picture.zoom(1.4), 'zoom out'),
                  button('z', zoomToContact, 'zoom to the contact'),
                  button('all', () => picture.showAll(), 'all of the picture')),
              element('p', {class: 'hint', text:
                  'Keys: ← → one frame, with Shift ten, Home, End, c contact, ' +
                  'z zoom to it, + − zoom, 0 whole picture, t touchdown is ' +
                  'here, e reason'}),
              element('div', {class: 'plots'}, gaps.node, residuals.node)),
          element('div', {class: 'tell'}, summary,
              proposalNote(data),
              warnings.length === 0 ? '' : element('ul', {class: 'warnings'},
                  ...warnings.map(w => element('li', {text: w}))),
              (view.corrections ?? []).length === 0 ? '' :
                  element('p', {class: 'hint', text: 'Corrected by hand: ' +
                                view.corrections.join('; ')}),
              old ? '' : correcting.node,
              element('h2', {text: 'History'}),
              historyList(data.history, data.row.revision,
                          data.last_revision, data.row.id,
                          async n => {
                correcting.why.value ||= `revision ${n} was right`;
                await correcting.store({restore: n});
                if (correcting.trouble.textContent) {
                  tell(correcting.trouble.textContent, true);
                }
              }),
              element('details', {}, element('summary', {text: 'All numbers'}),
                      details))));
  if (picture) picture.editing = !old && view.absent === undefined;
  view = structuredClone(data.view);
  describe(data.numbers);
  show(frame);
  await go(frame);

  return {
    keys(event) {
      if (event.target.closest?.('input, select, textarea') ) return;
      const far = event.shiftKey ? 10 : 1;
      const act = {
        ArrowRight: () => go(frame + far), ArrowLeft: () => go(frame - far),
        Home: () => go(0), End: () => go(frames - 1),
        c: () => go(contact() ?? frame), z: zoomToContact,
        '+': () => picture?.zoom(0.7), '-': () => picture?.zoom(1.4),
        0: () => picture?.showAll(), e: () => correcting.why.focus(),
        t: () => old || correcting.setContact(),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    },
    async changed() {
      const now = await get(`/api/trials/${data.row.id}`);
      if (now.last_revision === data.last_revision) return;
      const last = now.history.find(h => h.revision === now.last_revision);
      if (correcting.pending() || old) {
        tell(`Revision ${last.revision} was made meanwhile: ${last.kind} by ` +
             `${last.who}${last.why ? ': ' + last.why : ''}.`, true);
        return;
      }
      await page.saved();
      tell(`Revision ${last.revision}: ${last.kind} by ${last.who}` +
           `${last.why ? ': ' + last.why : ''}.`);
    },
  };
}

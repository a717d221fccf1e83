// One trial: pictures, plots, numbers, history, correction.
import {Correcting} from './correct.js';
import {historyList, proposalNote} from './history.js';
import {Look} from './look.js';
import {Loupe} from './loupe.js';
import {budget, checksList, conditionsTable, numbersTable, said}
    from './numbers.js';
import {neighbours} from './order.js';
import {movedForm} from './moved.js';
import {baseName, element, get, tell, tellNext} from './parts.js';
import {Picture} from './picture.js';
import {Playback} from './playback.js';
import {Plot} from './plots.js';

const kAround = 40;  // frames beside the contact that the plots show

// Links to the trials beside this one, filled when the list is known.
function neighbourLinks(id) {
  const node = element('nav', {class: 'beside', 'aria-label': 'Trials'});
  const found = {before: null, after: null};
  const link = (to, text) => to === null
      ? element('span', {class: 'muted', text})
      : element('a', {href: `#/trial/${to}`, text});
  neighbours(id).then(n => {
    Object.assign(found, n);
    node.replaceChildren(link(n.before, '‹ previous (p)'),
                         n.at === null ? '' : ` ${n.at} of ${n.of} `,
                         link(n.after, 'next (n) ›'));
  }, () => {});  // without a list there are no neighbours
  return {node, go(which) {
    if (found[which] !== null) location.hash = `#/trial/${found[which]}`;
  }};
}

function heading(data, old) {
  return [
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
                                    text: 'show that one'})) : '')];
}

export async function trial(main, id, revision) {
  const path = `/api/trials/${id}${revision ? `?revision=${revision}` : ''}`;
  const data = await get(path);
  const old = data.row.revision !== data.last_revision;
  const clip = data.clip;
  const frames = clip.absent === undefined ? clip.frames : 0;
  const contact = () => data.numbers.frame === null
      ? null : Math.floor(data.numbers.frame);
  let frame = Math.min(Math.max(contact() ?? 0, 0), Math.max(frames - 1, 0));
  let view = data.view;

  const frameUrl = n => `/api/trials/${data.row.id}/frames/${n}`;
  const picture = frames === 0 ? null : new Picture(
      clip.width_px, clip.height_px, frameUrl,
      'The recording with what was measured drawn over it',
      (p1, p2) => correcting.setGround(p1, p2));
  const loupe = frames === 0 ? null
                             : new Loupe(clip.width_px, clip.height_px, frameUrl);
  const gaps = new Plot('Gap', '', n => go(n));
  const residuals = new Plot('Height minus the fitted flights', '', n => go(n));
  const slider = element('input', {
    type: 'range', min: 0, max: Math.max(frames - 1, 0), value: frame,
    id: 'scrub', oninput: () => go(Number(slider.value))});
  const where = element('output', {id: 'frame', for: 'scrub'});
  const summary = element('div', {class: 'answer'});
  const details = element('div');

  function show(frameNow) {
    const has = view.absent === undefined;
    const around = contact();
    const first = has ? view.poses[0]?.[0] ?? 0 : 0;
    const last = has ? view.poses[view.poses.length - 1]?.[0] ?? 0 : 0;
    const from = Math.max(first, around === null ? first : around - kAround);
    const to = Math.min(last, around === null ? last : around + kAround);
    const unit = view.length_unit ?? 'px';
    gaps.unit = residuals.unit = unit;
    const bounce = view.bounce_height ?? null;
    gaps.show(has && view.gaps ? [{name: 'before', points: view.gaps}] : [],
              frameNow, from, to,
              `Height of the lowest point of the body above the ground, frames ` +
              `${from} to ${to}; ${data.numbers.state}` +
              (bounce === null ? '' : `; the line is the bounce height, ` +
               `${bounce.toFixed(2)} ${unit}`),
              bounce === null ? [] : [{
                value: bounce, text: `bounce height ${bounce.toFixed(2)}`}]);
    const of = name => (view.residuals ?? []).filter(r => r[1] === name).map(
        r => [r[0], r[4], r[5]]);
    residuals.show(has ? [{name: 'before', points: of('before')},
                          {name: 'after', points: of('after')}] : [],
                   frameNow, from, to,
                   'Circles before touchdown, squares after it; bars are two ' +
                   'standard uncertainties');
    for (const drawn of [picture, loupe]) {
      drawn?.show(view, correcting.asked.moved,
                  new Set(correcting.asked.left_out));
    }
  }

  function go(n) {
    if (frames === 0) return;
    frame = Math.min(Math.max(n, 0), frames - 1);
    slider.value = frame;
    where.textContent = `frame ${frame} of ${frames}`;
    gaps.moveCursor(frame);
    residuals.moveCursor(frame);
    loupe.showFrame(frame);
    return picture.showFrame(frame);
  }

  function describe(numbers) {
    summary.replaceChildren(said(numbers), checksList(view.checks) ?? '');
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
  const beside = neighbourLinks(data.row.id);
  const playback = new Playback({frames, fps: view.fps ?? 0, contact, go,
                                 frame: () => frame});

  function showContact() {
    const at = view.contact?.touching_px ??
        view.poses?.find(p => p[0] === frame)?.slice(1, 3);
    if (!at || !picture) return;
    const body = view.body;
    const size = body.kind === 'sphere' ? 2 * body.radius_px
                                        : 2 * body.half_long_px;
    picture.zoomTo(at[0], at[1], Math.max(24, size * 2.5));
    go(contact() ?? frame);
  }

  const button = (text, act, label) => element(
      'button', {type: 'button', text, onclick: act, 'aria-label': label});
  const warnings = [...(view.warnings ?? []), ...(view.refuted ? [view.refuted]
                                                                : [])];
  const see = element('div', {class: 'see'});
  see.append(
      picture?.node ?? element('div', {},
          element('p', {class: 'bad', text: `No pictures: ${clip.absent}`}),
          data.row.clip.path ? movedForm(data.row.clip.path,
                                         () => page.saved()) : ''),
      ...(frames === 0 ? [] : [
        element('div', {class: 'scrub'},
            element('label', {for: 'scrub', text: 'Frame'}), slider, where),
        element('div', {class: 'scrub'}, playback.node),
        element('div', {class: 'scrub'},
            button('Contact', () => go(contact() ?? frame)),
            button('Zoom to it', showContact),
            button('+', () => picture.zoom(0.7), 'zoom in'),
            button('−', () => picture.zoom(1.4), 'zoom out'),
            button('Whole picture', () => picture.showAll()))]),
      element('p', {class: 'hint', text:
          'Keys: ← → one frame, with Shift ten, Home, End, space play, l loop, ' +
          'c contact, z shows it enlarged, + − zoom, 0 whole picture, ' +
          't touchdown is here, e reason, n p next and previous trial'}),
      element('div', {class: 'beneath'},
          frames === 0 ? '' : element('div', {class: 'lens'},
              element('figure', {}, loupe.node, element('figcaption', {
                text: 'The contact point in this frame'})),
              new Look(see).node),
          element('div', {class: 'plots'}, gaps.node, residuals.node,
              view.absent === undefined && view.length_unit === 'mm'
                  ? element('p', {}, element('a', {
                      href: `/api/trials/${data.row.id}/trajectory.csv` +
                          `?revision=${data.row.revision}`, download: true,
                      text: 'Trajectory as CSV'})) : '')));
  main.replaceChildren(
      beside.node, ...heading(data, old),
      element('div', {class: 'trial'}, summary, see,
          element('div', {class: 'tell'},
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
  page.reset();
  await go(frame);
  if (!old) correcting.takeUpDraft();

  return {
    keys(event) {
      if (event.target.closest?.('input, select, textarea') ) return;
      // On a button or link, space is that one's.
      if (event.key === ' ' && event.target.closest?.('button, a, summary')) {
        return;
      }
      const far = event.shiftKey ? 10 : 1;
      const act = {
        ArrowRight: () => go(frame + far), ArrowLeft: () => go(frame - far),
        Home: () => go(0), End: () => go(frames - 1),
        c: () => go(contact() ?? frame), z: showContact,
        '+': () => picture?.zoom(0.7), '-': () => picture?.zoom(1.4),
        0: () => picture?.showAll(), e: () => correcting.why.focus(),
        t: () => old || correcting.setContact(),
        ' ': () => frames === 0 || playback.toggle(),
        l: () => playback.toggleLoop(),
        n: () => beside.go('after'), p: () => beside.go('before'),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    },
    close() { playback.stop(); },
    // The server was away: what it did not give is asked for again.
    back: () => go(frame),
    pending: () => correcting.pending(),
    async changed() {
      const now = await get(`/api/trials/${data.row.id}`);
      await correcting.stored;  // the change may be what is being stored here
      if (now.last_revision === data.last_revision) return null;
      const last = now.history.find(h => h.revision === now.last_revision);
      const what = `${last.kind} by ${last.who}` +
          `${last.why ? ': ' + last.why : ''}.`;
      if (correcting.pending() || old) {
        return () => tell(
            `Revision ${last.revision} was made meanwhile: ${what}`, true);
      }
      return () => {
        tellNext(`Revision ${last.revision}: ${what}`);
        page.saved();
      };
    },
  };
}

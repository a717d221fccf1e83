// Recordings of the folders that the server was given: chosen, analysed with
// progress, logged; each analysis can be cancelled.
import {element, get, post, table, tell} from './parts.js';
import {clearTrouble, conditions, field, number, select, showTrouble, valuesOf}
    from './forms.js';

// While something is analysed the person waits for it.
const kAskEvery_ms = 400;

function size(bytes) {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} kB`
                     : `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;
}

function day(written_s) {
  if (written_s === undefined) return '–';
  const when = new Date(written_s * 1000);
  const two = n => String(n).padStart(2, '0');
  return `${when.getFullYear()}-${two(when.getMonth() + 1)}-` +
      `${two(when.getDate())} ${two(when.getHours())}:${two(when.getMinutes())}`;
}

export function isOver(analysis) {
  return analysis.state !== 'waiting' && analysis.state !== 'running';
}

// One analysis: what becomes of it, and a button that ends it.
export function progressOf(analysis, cancel) {
  const {state, frames, frames_done, ahead} = analysis;
  if (state === 'waiting') {
    return [`waits for ${ahead} other${ahead === 1 ? '' : 's'} `, cancel];
  }
  if (state === 'running') {
    // The contact is found and judged once all frames have been read.
    const text = frames_done < frames
        ? `frame ${frames_done} of ${frames}` : 'measuring the contact';
    return [element('progress', {max: frames, value: frames_done,
                                 'aria-label': `frames of ${analysis.name}`}),
            ` ${text} `, cancel];
  }
  if (state === 'cancelled') return ['cancelled; nothing was stored'];
  if (state === 'failed') {
    return [element('span', {class: 'bad', text: analysis.trouble})];
  }
  return [];
}

export function cancelButton(analysis, after) {
  return element('button', {
    type: 'button', text: 'Cancel', 'aria-label': `cancel ${analysis.name}`,
    onclick: async () => {
      await post(`/api/analyses/${analysis.id}/cancel`, {})
          .catch(error => tell(error.message, true));
      after();
    }});
}

function analysisLine(analysis, again, refresh) {
  const line = element('li', {}, element('strong', {text: analysis.name}),
                       ` (${analysis.campaign}): `);
  line.dataset.id = analysis.id;
  line.dataset.state = analysis.state;
  line.append(...progressOf(analysis, cancelButton(analysis, refresh)));
  if (analysis.trial) {
    line.append(
        element('a', {href: `#/trial/${analysis.trial}`, text: analysis.said}),
        analysis.state === 'known' ? ': the store had this answer ' : ' ');
  }
  if (analysis.state === 'failed') {
    line.append(' ', element('button', {
      type: 'button', text: 'Analyse it again', onclick: () => again(analysis)}));
  }
  return line;
}

function recordingRows(folders, place, choose) {
  return folders[place].recordings.map(r => [
    element('label', {}, choose(place, r.name),
            element('span', {text: r.name === '.' ? 'pictures' : r.name})),
    day(r.written_s),
    {text: size(r.bytes), class: 'num'},
    r.trials.length === 0 ? {text: 'not yet', class: 'muted'}
        : element('span', {}, ...r.trials.flatMap((t, i) => [
            i === 0 ? '' : ', ',
            element('a', {href: `#/trial/${t.id}`,
                          text: t.campaign || 'no campaign'})])),
  ]);
}

// Tables of the folders' recordings; `choose(folder, name)` makes what stands
// before each name.
export function recordingTables(folders, choose) {
  return folders.map((f, place) => element('div', {class: 'list'},
      f.trouble ? element('p', {class: 'bad', text: f.trouble})
                : table(f.folder, ['recording', 'written',
                                   {text: 'size', class: 'num'}, 'trial'],
                        recordingRows(folders, place, choose))));
}

export function noFolders() {
  return element('p', {}, 'The server was given no folder of recordings: end ' +
      'it and start it with ',
      element('code', {text: 'touchdown review --recordings FOLDER'}), '.');
}

export async function recordings(main) {
  let data = await get('/api/recordings');
  const list = element('div');
  const queue = element('ul', {class: 'queue', 'aria-label': 'Analyses'});
  const trouble = element('p', {class: 'bad', role: 'alert'});
  const chosen = new Set();
  const key = (folder, name) => `${folder}/${name}`;
  const send = element('button', {class: 'main', text: 'Analyse and log'});
  const camera = element('span', {class: 'hint'});
  const other = element('input', {type: 'checkbox'});
  let campaign = null;
  let made = null;
  let timer = null;
  let closed = false;

  const choose = (folder, name) => {
    const box = element('input', {type: 'checkbox',
                                  checked: chosen.has(key(folder, name))});
    box.addEventListener('change', () => {
      if (box.checked) chosen.add(key(folder, name));
      else chosen.delete(key(folder, name));
      count();
    });
    return box;
  };

  function count() {
    send.disabled = chosen.size === 0;
    send.textContent = chosen.size < 2 ? 'Analyse and log'
                                       : `Analyse and log ${chosen.size}`;
  }

  function showCamera() {
    const known = data.campaigns.find(c => c.name === campaign.value)?.camera;
    camera.textContent = known ? `as the campaign's last recording: ${known}`
        : 'as the recording says; scale from the body’s size';
    other.closest('.field').hidden = !known;
  }

  async function refresh() {
    clearTimeout(timer);
    if (closed) return;
    try {
      const {analyses} = await get('/api/analyses');
      const logs = analyses.filter(a => !a.is_test).reverse();
      const focused = document.activeElement?.closest?.('.queue li')?.dataset.id;
      queue.replaceChildren(...logs.map(a => analysisLine(a, again, refresh)));
      if (focused) {
        queue.querySelector(`li[data-id="${focused}"] :is(button, a)`)?.focus();
      }
      if (logs.some(a => !isOver(a))) timer = setTimeout(refresh, kAskEvery_ms);
    } catch (error) {
      tell(error.message, true);
    }
  }

  async function ask(recording, more) {
    await post('/api/analyses', {...valuesOf(made), recording, ...more});
  }

  async function again(analysis) {
    const {folder, name} = analysis;
    try {
      await ask({folder, name}, {campaign: analysis.campaign, again: true});
    } catch (error) {
      showTrouble(made, error, trouble);
    }
    await refresh();
  }

  async function submit(event) {
    event.preventDefault();
    clearTrouble(made, trouble);
    for (const one of [...chosen]) {
      const slash = one.indexOf('/');
      try {
        await ask({folder: Number(one.slice(0, slash)),
                   name: one.slice(slash + 1)}, {});
        chosen.delete(one);
      } catch (error) {
        showTrouble(made, error, trouble);
        break;
      }
    }
    showList();
    await refresh();
  }

  function showList() {
    list.replaceChildren(...recordingTables(data.folders, choose));
    count();
  }

  const names = data.campaigns.map(c => c.name);
  if (names.length > 0 && data.folders.length > 0) {
    campaign = select(names);
    campaign.addEventListener('change', showCamera);
    made = element('form', {class: 'card choose', 'aria-label': 'Analyse', novalidate:
                            true},
        field('clip', 'campaign', 'Campaign', campaign),
        element('div', {class: 'field'}, element('span', {text: 'Camera'}),
                camera),
        field('clip', 'other_camera', 'The camera was moved or set otherwise',
              other),
        field('clip', 'set_angle_deg', 'Set angle, deg', number()),
        field('clip', 'set_speed_mps', 'Set speed, m/s', number()),
        conditions('clip'), trouble, send);
    made.addEventListener('submit', submit);
    showCamera();
  }
  main.replaceChildren(
      element('h1', {text: 'Recordings'}),
      data.folders.length === 0 ? noFolders() : list,
      element('p', {}, element('a', {href: '#/setup', text: names.length === 0
          ? 'Make the first campaign from one of them'
          : 'Make another campaign from one of them'})),
      made ?? '', queue);
  showList();
  await refresh();
  return {
    async changed() {
      data = await get('/api/recordings');
      showList();
      if (campaign) showCamera();
      await refresh();
    },
    close() {
      closed = true;
      clearTimeout(timer);
    },
  };
}

// A campaign made by clicks: a recording is chosen, body, scale and ground are
// told, and the recording is analysed with them and shown. Nothing is stored
// until the person keeps it: then the campaign and its first trial are.
import {element, get, post, table, who} from './parts.js';
import {clearTrouble, field, number, select, showTrouble, valuesOf}
    from './forms.js';
import {LensPart} from './lens.js';
import {Marks} from './marks.js';
import {Picture} from './picture.js';
import {cancelButton, isOver, noFolders, progressOf, recordingTables}
    from './recordings.js';

const kAskEvery_ms = 300;

const kChecks = {
  explained: 'The outline explains what changes in the clip',
  size: 'The body is as large as stated',
  shape: 'All of the outline is seen to be the body',
  path: 'The body flies freely before and after',
  restitution: 'The rebound is possible',
  gravity: 'Gravity comes out right',
};
const kVerdicts = {
  passed: '✓ yes', doubtful: '? doubtful',
  refused: '✗ no: so no answer is given', 'not made': '– not checked',
};
const kSources = {
  calibration: 'as marked', user: 'as stated', body_size: 'from the body’s size',
  detected: 'found in the clip', 'contact-points': 'from where the body touched',
};

function sourceText(source) { return kSources[source] ?? source; }

function answerOf(test) {
  const {numbers, settings, checks} = test;
  const passed = checks.every(c => c.verdict !== 'refused');
  return element('div', {class: 'answer'},
      element('dl', {class: 'said'},
          element('dt', {text: `${numbers.angle_kind} angle`}),
          element('dd', {class: 'angle', text: numbers.angle}),
          element('dt', {text: 'state'}),
          element('dd', {class: 'state', text: numbers.state}),
          element('dt', {text: 'because'}),
          element('dd', {text: numbers.state_reason || numbers.reason || '–'}),
          element('dt', {text: 'scale'}),
          element('dd', {text: settings.scale
              ? `${settings.scale} (${sourceText(settings.scale_source)})`
              : settings.scale_source}),
          element('dt', {text: 'ground'}),
          element('dd', {text: sourceText(settings.ground_source)}),
          element('dt', {text: 'frame rate'}),
          element('dd', {text: `${settings.fps} frames/s` +
              (settings.fps_trusted ? '' : ': the file’s own, which is often ' +
                                           'that of playback')})),
      checks.length === 0 ? '' :
      table(passed ? 'Does the answer explain the clip?'
                   : 'The answer does not explain the clip: look at what is ' +
                     'stated',
            ['check', 'result'],
            checks.map(c => [
              kChecks[c.name] ?? c.name,
              {text: `${kVerdicts[c.verdict] ?? c.verdict}` +
                     `${c.reason ? ': ' + c.reason : ''}`,
               class: c.verdict === 'refused' ? 'bad' : null}]),
            {class: 'checks'}),
      test.warnings.length === 0 ? '' : element('ul', {class: 'warnings'},
          ...test.warnings.map(w => element('li', {text: w}))));
}

// The fields of a campaign; more of them where they are asked for.
function campaignFields(kind) {
  const part = input => { input.dataset.part = 'campaign'; return input; };
  const text = size => element('input', {size, autocomplete: 'off'});
  const line = (name, label, input) =>
      field('setup', name, label, part(input));
  const diameter = line('diameter_mm', 'Diameter, mm (40 or 40+-0.02)',
                        number());
  const sides = line('sides_mm', 'Sides, mm (60x20)', number());
  const show = () => {
    sides.hidden = kind.value !== 'rectangle';
    diameter.hidden = !sides.hidden;
    // What is not shown is not sent.
    for (const one of [sides, diameter]) {
      if (one.hidden) one.querySelector('input').value = '';
    }
  };
  kind.addEventListener('change', show);
  show();
  return [
    line('name', 'Name of the campaign', text(26)),
    line('body', 'Body', kind), diameter, sides,
    line('surface', 'Surface', text(26)),
    element('details', {},
            element('summary', {text: 'Theory and conventions, fixed by the ' +
                                      'first trial'}),
            line('theory', 'Theory that gets a verdict', text(20)),
            line('theory_boundary_deg', 'Its boundary angle, deg', number()),
            line('theory_u_deg', 'its standard uncertainty, deg', number()),
            line('margin_deg', 'Equivalence margin, deg (1)', number()),
            line('speed_mps', 'Band of the speed, m/s (3.5:4.5)', number()),
            line('angle_kind', 'Varied angle',
                 select(['', 'approach', 'radius', 'face'])),
            line('bounce_height_mm', 'Bounce height, mm (2 % of the body, at ' +
                 'least 0.5)', number())),
  ];
}

export async function setup(main) {
  const data = await get('/api/recordings');
  const all = data.folders.flatMap((f, folder) => f.recordings.map(
      r => ({folder, name: r.name, isFolder: r.is_folder})));
  const see = element('div', {class: 'see'});
  const answer = element('div', {class: 'tell'});
  const trouble = element('p', {class: 'bad', role: 'alert'});
  const progress = element('p', {role: 'status'});
  const send = element('button', {class: 'main', text: 'Analyse'});
  const kind = element('select', {},
      element('option', {value: 'sphere', text: 'sphere'}),
      element('option', {value: 'rectangle', text: 'block (rectangle)'}));
  const fps = number();
  const length = number();
  const scaleHint = element('span', {class: 'hint'});
  const groundHint = element('span', {class: 'hint'});
  let recording = null;
  let picture = null;
  let marks = null;
  let timer = null;
  let closed = false;
  let analysis = null;

  const marking = (name, label, hint) => {
    const put = element('button', {type: 'button', text: label, onclick: () => {
      marks?.begin(name, label);
      picture?.node.scrollIntoView({block: 'nearest'});
    }});
    const away = element('button', {type: 'button', text: 'Remove',
        'aria-label': `remove: ${label}`, onclick: () => marks?.remove(name)});
    away.hidden = true;
    return {row: element('div', {class: 'buttons'}, put, away, hint), put, away};
  };
  const scale = marking('scale', 'Mark two points of known distance', scaleHint);
  const ground = marking('ground', 'Mark two points of the ground', groundHint);

  function onMarks() {
    for (const [name, {away}] of [['scale', scale], ['ground', ground]]) {
      away.hidden = !marks.of(name);
    }
    lengthField.hidden = !marks.of('scale');
    if (lengthField.hidden) length.value = '';
    scaleHint.textContent = marks.of('scale')
        ? `${marks.length('scale').toFixed(1)} px apart; click on the picture`
        : 'else from the body’s size';
    groundHint.textContent = marks.of('ground')
        ? 'click on the picture, left and right' : 'else found in the clip';
  }

  const lens = new LensPart(data);
  const camera = input => { input.dataset.part = 'camera'; return input; };
  const lengthField = field('setup', 'length_mm', 'Their distance, mm',
                            camera(length));
  const form = element('form', {class: 'card', 'aria-label': 'New campaign',
                                novalidate: true},
      element('h2', {text: 'The campaign and its body'}),
      ...campaignFields(kind),
      element('h2', {text: 'Camera, scale and ground'}),
      field('setup', 'fps', 'Frames per second', camera(fps)),
      field('setup', 'camera', 'Camera (its name)', camera(element('input', {
        size: 20, autocomplete: 'off'}))),
      scale.row, lengthField, ground.row, lens.node, trouble, progress, send);

  async function chooseRecording(next) {
    recording = next;
    see.replaceChildren(element('p', {text: 'Loading …'}));
    const query = `folder=${next.folder}&name=${encodeURIComponent(next.name)}`;
    let clip;
    try {
      clip = await get(`/api/recordings/clip?${query}`);
    } catch (error) {
      send.disabled = true;
      see.replaceChildren(element('p', {class: 'bad', role: 'alert',
                                        text: error.message}));
      return;
    }
    send.disabled = false;
    fps.placeholder = clip.time_base
        ? `${clip.time_base.fps}, as the file says` : 'the camera’s';
    picture = new Picture(clip.width_px, clip.height_px,
                          n => `/api/recordings/frame?${query}&frame=${n}`,
                          'The recording; marks are put on it', () => {});
    marks = new Marks(picture, onMarks);
    onMarks();
    const where = element('output', {for: 'setup-frame'});
    const slider = element('input', {
      type: 'range', id: 'setup-frame', min: 0, max: clip.frames - 1, value: 0,
      oninput: () => go(Number(slider.value))});
    const go = n => {
      slider.value = n;
      where.textContent = `frame ${slider.value} of ${clip.frames}`;
      return picture.showFrame(Number(slider.value));
    };
    picture.go = go;
    const button = (text, label, act) => element(
        'button', {type: 'button', text, 'aria-label': label, onclick: act});
    see.replaceChildren(picture.node, element('div', {class: 'scrub'},
        element('label', {for: 'setup-frame', text: 'Frame'}), slider, where,
        button('+', 'zoom in', () => picture.zoom(0.7)),
        button('−', 'zoom out', () => picture.zoom(1.4)),
        button('all', 'all of the picture', () => picture.showAll())));
    await go(0);
  }

  function showAnswer(test) {
    const view = test.view;
    picture.show(view);
    const frame = test.numbers.frame;
    if (frame !== null) picture.go(Math.floor(frame));
    const keep = element('button', {
      class: frame === null ? null : 'main', type: 'button',
      onclick: () => keepIt(keep),
      text: frame === null ? 'Keep it without an answer'
                           : 'Keep it: make the campaign and log this trial'});
    answer.replaceChildren(
        element('h2', {text: 'What it says'}), answerOf(test),
        element('p', {class: 'hint', text: 'Nothing is stored yet. Change ' +
            'what is not right and analyse again, or keep it.'}), keep,
        element('p', {class: 'bad', role: 'alert', id: 'keep-trouble'}));
    answer.scrollIntoView({block: 'nearest'});
  }

  async function keepIt(button) {
    const said = document.getElementById('keep-trouble');
    said.textContent = '';
    button.disabled = true;
    try {
      const kept = await post(`/api/analyses/${analysis}/keep`, {who: who()});
      location.hash = `#/trial/${kept.id}`;
    } catch (error) {
      showTrouble(form, error, said);
      button.disabled = false;
    }
  }

  async function follow(id) {
    clearTimeout(timer);
    if (closed || id !== analysis) return;
    try {
      const now = await get(`/api/analyses/${id}`);
      progress.replaceChildren(
          ...progressOf(now, cancelButton(now, () => follow(id))));
      if (!isOver(now)) {
        timer = setTimeout(() => follow(id), kAskEvery_ms);
        return;
      }
      send.disabled = false;
      if (now.state === 'done') showAnswer(now.test);
    } catch (error) {
      send.disabled = false;
      progress.replaceChildren();
      trouble.textContent = error.message;
    }
  }

  form.addEventListener('submit', async event => {
    event.preventDefault();
    clearTrouble(form, trouble);
    answer.replaceChildren();
    picture.show(null);
    send.disabled = true;
    const {folder, name} = recording;
    const asked = {...valuesOf(form), recording: {folder, name}};
    asked.camera.scale_px = marks.of('scale');
    asked.camera.ground_px = marks.of('ground');
    asked.camera.lens = lens.calibration;
    try {
      analysis = (await post('/api/tests', asked)).id;
      await follow(analysis);
    } catch (error) {
      showTrouble(form, error, trouble);
      send.disabled = false;
    }
  });

  const choose = (folder, name) => {
    const radio = element('input', {type: 'radio', name: 'recording'});
    radio.checked = recording?.folder === folder && recording?.name === name;
    radio.addEventListener('change', () => chooseRecording({folder, name}));
    return radio;
  };
  // One recording needs no choice; of several the first is shown, of folders of
  // pictures, which may show a board, only where there is nothing else.
  recording = all.find(r => !r.isFolder) ?? all[0] ?? null;
  const list = element('details', {open: all.length > 1},
      element('summary', {text: all.length === 0 ? 'No recording is there yet'
          : `Recording: ${all.length} to choose from`}),
      ...recordingTables(data.folders, choose));
  main.replaceChildren(
      element('h1', {text: 'New campaign'}),
      data.store_missing ? element('p', {text: `There is no store at ` +
          `${data.store} yet; it is made when the first answer is kept.`}) : '',
      data.folders.length === 0 ? noFolders() : list,
      all.length === 0 ? '' : element('div', {class: 'trial setup'},
          element('div', {}, see, answer), form));
  if (recording) await chooseRecording(recording);
  return {
    keys() {},
    close() {
      closed = true;
      clearTimeout(timer);
    },
  };
}

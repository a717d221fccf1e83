// Logging a trial: by hand, or a recording of this machine. What was typed
// stays where something is wrong, and the trouble stands beside its field.
import {element, get, post, Refused, tell, who} from './parts.js';

const kStates = ['', 'bounce', 'slide', 'roll-slide', 'roll', 'stick',
                 'stays-down', 'undecided'];

function field(prefix, name, label, input) {
  const id = `${prefix}-${name}`;
  input.id = id;
  input.name = name;
  input.setAttribute('aria-describedby', `${id}-trouble`);
  return element('div', {class: 'field'}, element('label', {for: id, text: label}),
                 input, element('span', {id: `${id}-trouble`, class: 'bad'}));
}

function select(words) {
  return element('select', {}, ...words.map(
      w => element('option', {value: w, text: w || '–'})));
}

function number() {
  return element('input', {inputmode: 'decimal', autocomplete: 'off', size: 9});
}

function form(title, prefix, path, fields, doing) {
  const send = element('button', {class: 'main', text: 'Log it'});
  const done = element('p', {role: 'status'});
  const trouble = element('p', {class: 'bad', role: 'alert'});
  const made = element('form', {class: 'card', 'aria-label': title, novalidate:
                                true},
                       element('h2', {text: title}), ...fields, trouble, done,
                       send);
  const say = (name, text) => {
    const input = made.elements[name];
    if (!input) return false;
    document.getElementById(`${input.id}-trouble`).textContent = text;
    input.setAttribute('aria-invalid', text ? 'true' : 'false');
    return true;
  };
  made.addEventListener('submit', async event => {
    event.preventDefault();
    trouble.textContent = '';
    done.textContent = doing;
    send.disabled = true;
    const asked = {who: who()};
    for (const input of made.elements) {
      if (!input.name) continue;
      const into = input.dataset.condition ? asked.conditions ??= {} : asked;
      into[input.dataset.condition ?? input.name] = input.value.trim();
      say(input.name, '');
    }
    try {
      const logged = await post(path, asked);
      done.replaceChildren(
          logged.is_new ? 'Logged: ' : 'A further revision of a known trial: ',
          element('a', {href: `#/trial/${logged.id}`,
                        text: `trial ${logged.id.slice(0, 8)}`}));
      tell('Logged.');
      for (const input of made.elements) {
        if (input.tagName === 'INPUT') input.value = '';
      }
    } catch (error) {
      done.textContent = '';
      const named = error instanceof Refused && error.answer.field
          ? error.answer.field.replaceAll('-', '_') : null;
      const name = named && made.elements[`condition_${named}`]
          ? `condition_${named}` : named;
      if (name === 'who') {
        trouble.textContent = `Your name (above) ${error.answer.problem}`;
        document.getElementById('who').focus();
      } else if (name && say(name, error.answer.problem)) {
        made.elements[name].focus();
      } else {
        trouble.textContent = error.message;
      }
    }
    send.disabled = false;
  });
  return made;
}

// What the shot was made with: the keys of `--condition`.
const kConditions = [
  ['elevation_deg', 'Elevation, deg', '12.5+-0.2'],
  ['compression_mm', 'Compression, mm', '30+-0.3'],
  ['muzzle_height_mm', 'Muzzle height, mm', '300+-1'],
  ['rig', 'Rig', 'as in the register'],
  ['spring', 'Spring', 'as in the register'],
  ['camera', 'Camera', 'as in the register'],
  ['temperature_c', 'Air, °C', '21.5+-0.5'],
  ['note', "Operator's note", ''],
];

function conditions(prefix) {
  const fields = kConditions.map(([key, label, placeholder]) => {
    const input = element('input', {size: 16, placeholder,
                                    autocomplete: 'off'});
    input.dataset.condition = key;
    return field(prefix, `condition_${key}`, label, input);
  });
  return element('details', {}, element('summary', {text: 'As it was set'}),
                 ...fields);
}

export async function log(main) {
  const {campaigns} = await get('/api/trials');
  const names = campaigns.map(c => c.name);
  const campaign = prefix => field(prefix, 'campaign', 'Campaign',
                                   select(names));
  main.replaceChildren(
      element('h1', {text: 'Log a trial'}),
      names.length === 0
          ? element('p', {text: 'There is no campaign yet: make one with ' +
                                '`touchdown campaign new`.'})
          : element('div', {class: 'cards'},
      form('By hand', 'hand', '/api/log', [
        campaign('hand'),
        field('hand', 'state', 'Motion state', select(kStates)),
        field('hand', 'angle_deg', 'Contact angle, deg', number()),
        field('hand', 'angle_u_deg', 'its standard uncertainty, deg', number()),
        field('hand', 'set_angle_deg', 'Set angle, deg', number()),
        field('hand', 'set_speed_mps', 'Set speed, m/s', number()),
        field('hand', 'corner', 'Corner (rectangle)',
              select(['', 'leading', 'trailing', 'flush'])),
        field('hand', 'note', 'What was seen', element('input', {size: 34})),
        conditions('hand'),
      ], 'Logging …'),
      form('A recording', 'clip', '/api/recordings', [
        campaign('clip'),
        field('clip', 'clip', 'Path on this machine',
              element('input', {size: 34, spellcheck: 'false'})),
        field('clip', 'set_angle_deg', 'Set angle, deg', number()),
        field('clip', 'set_speed_mps', 'Set speed, m/s', number()),
        conditions('clip'),
      ], 'Analysing … this takes some seconds.')));
}

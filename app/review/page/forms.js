// Forms: fields with their label and their trouble beside them. What was typed
// stays where something is wrong.
import {element, Refused, who} from './parts.js';

export function field(prefix, name, label, input) {
  const id = `${prefix}-${name}`;
  input.id = id;
  input.name = name;
  input.setAttribute('aria-describedby', `${id}-trouble`);
  return element('div', {class: 'field'}, element('label', {for: id, text: label}),
                 input, element('span', {id: `${id}-trouble`, class: 'bad'}));
}

export function select(words) {
  return element('select', {}, ...words.map(
      w => element('option', {value: w, text: w || '–'})));
}

export function number() {
  return element('input', {inputmode: 'decimal', autocomplete: 'off', size: 9});
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

export function conditions(prefix) {
  const fields = kConditions.map(([key, label, placeholder]) => {
    const input = element('input', {size: 16, placeholder,
                                    autocomplete: 'off'});
    input.dataset.condition = key;
    return field(prefix, `condition_${key}`, label, input);
  });
  return element('details', {}, element('summary', {text: 'As it was set'}),
                 ...fields);
}

function say(form, name, text) {
  const input = form.elements[name];
  if (!input?.id) return false;
  document.getElementById(`${input.id}-trouble`).textContent = text;
  input.setAttribute('aria-invalid', text ? 'true' : 'false');
  return true;
}

// What stands in the form, by the fields' names, and who says it. A field with
// data-part goes into the object of that name.
export function valuesOf(form) {
  const asked = {who: who()};
  for (const input of form.elements) {
    if (!input.name) continue;
    const part = input.dataset.condition ? 'conditions' : input.dataset.part;
    const into = part ? asked[part] ??= {} : asked;
    into[input.dataset.condition ?? input.name] =
        input.type === 'checkbox' ? input.checked : input.value.trim();
  }
  return asked;
}

export function clearTrouble(form, trouble) {
  trouble.textContent = '';
  for (const input of form.elements) {
    if (input.name) say(form, input.name, '');
  }
}

// Beside its field where the server named one that is in the form.
export function showTrouble(form, error, trouble) {
  const named = error instanceof Refused && error.answer.field
      ? error.answer.field.replaceAll('-', '_') : null;
  const name = named && form.elements[`condition_${named}`]
      ? `condition_${named}` : named;
  if (name === 'who') {
    trouble.textContent = `Your name (above) ${error.answer.problem}`;
    document.getElementById('who').focus();
  } else if (name && say(form, name, error.answer.problem)) {
    form.elements[name].closest('details')?.setAttribute('open', '');
    form.elements[name].focus();
  } else {
    trouble.textContent = error.message;
  }
}

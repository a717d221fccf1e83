// A recording that is not where it was: looked for in a folder, by what it is
// and not by its name.
import {element, post, tellNext} from './parts.js';

export function movedForm(path, found) {
  const folder = element('input', {
    id: 'moved', size: 40, value: path.replace(/\/[^/]*$/, ''),
    'aria-describedby': 'moved-said'});
  const said = element('p', {id: 'moved-said', role: 'status'});
  const send = element('button', {type: 'submit', text: 'Look for it'});
  return element('form', {class: 'moved', onsubmit: async event => {
    event.preventDefault();
    send.disabled = true;
    said.className = '';
    said.textContent = 'Looking …';
    try {
      const answer = await post('/api/relink', {folder: folder.value});
      const moved = answer.found.find(move => move.from === path);
      if (moved) {
        tellNext(`Found: ${moved.to}` + (answer.found.length > 1
            ? `, and ${answer.found.length - 1} more recordings.` : '.'));
        await found();
        return;
      }
      said.textContent = `It is none of the ${answer.looked_at} recordings ` +
          `there; ${answer.found.length} others were found.`;
    } catch (error) {
      said.className = 'bad';
      said.textContent = error.message;
    }
    send.disabled = false;
  }},
      element('label', {for: 'moved', text:
          'Was it moved? The folder it is in, or one above: '}),
      folder, ' ', send, said);
}

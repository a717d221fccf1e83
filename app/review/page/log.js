// Logging a trial by hand.
import {element, get, post, tell} from './parts.js';
import {clearTrouble, conditions, field, number, select, showTrouble, valuesOf}
    from './forms.js';

const kStates = ['', 'bounce', 'slide', 'roll-slide', 'roll', 'stick',
                 'stays-down', 'undecided'];

function form(title, path, fields) {
  const send = element('button', {class: 'main', text: 'Log it'});
  const done = element('p', {role: 'status'});
  const trouble = element('p', {class: 'bad', role: 'alert'});
  const made = element('form', {class: 'card', 'aria-label': title, novalidate:
                                true},
                       element('h2', {text: title}), ...fields, trouble, done,
                       send);
  made.addEventListener('submit', async event => {
    event.preventDefault();
    clearTrouble(made, trouble);
    done.textContent = 'Logging …';
    send.disabled = true;
    try {
      const logged = await post(path, valuesOf(made));
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
      showTrouble(made, error, trouble);
    }
    send.disabled = false;
  });
  return made;
}

export async function log(main) {
  const {campaigns} = await get('/api/trials');
  const names = campaigns.map(c => c.name);
  main.replaceChildren(
      element('h1', {text: 'Log a trial'}),
      element('p', {}, 'What was filmed is analysed and logged under ',
              element('a', {href: '#/recordings', text: 'Recordings'}), '.'),
      names.length === 0
          ? element('p', {}, 'There is no campaign yet: ',
                    element('a', {href: '#/setup', text: 'make one'}), '.')
          : element('div', {class: 'cards'},
      form('By hand', '/api/log', [
        field('hand', 'campaign', 'Campaign', select(names)),
        field('hand', 'state', 'Motion state', select(kStates)),
        field('hand', 'angle_deg', 'Contact angle, deg', number()),
        field('hand', 'angle_u_deg', 'its standard uncertainty, deg', number()),
        field('hand', 'set_angle_deg', 'Set angle, deg', number()),
        field('hand', 'set_speed_mps', 'Set speed, m/s', number()),
        field('hand', 'corner', 'Corner (rectangle)',
              select(['', 'leading', 'trailing', 'flush'])),
        field('hand', 'note', 'What was seen', element('input', {size: 34})),
        conditions('hand'),
      ])));
}

// A server that was started anew has another key: the tab asks for it and goes
// on where it was.
import {baseName, element, get, tell} from './parts.js';

// `then`: the key was right.
function keyForm(then) {
  const field = element('input', {
    id: 'key', size: 44, autocomplete: 'off',
    placeholder: 'http://127.0.0.1:…/?token=…'});
  const trouble = element('span', {class: 'bad', role: 'alert'});
  const send = async event => {
    event.preventDefault();
    const given = field.value.trim();
    const other = URL.canParse(given) ? new URL(given) : null;
    if (other && other.origin !== location.origin) {
      location.href = given;  // it listens elsewhere now
      return;
    }
    const key = other?.searchParams.get('token') ?? given;
    const answer = await fetch('/?token=' + encodeURIComponent(key)).catch(
        () => null);
    if (answer?.ok) {
      then();
    } else {
      trouble.textContent = answer ? ' That is not its key.'
                                   : ' The server does not answer.';
    }
  };
  return element('form', {class: 'key', onsubmit: send},
      element('label', {for: 'key', text:
          'The server was started anew. Nothing that you began is lost. The ' +
          'address that it printed: '}),
      field, ' ', element('button', {type: 'submit', text: 'Go on'}), trouble);
}

function nameStore(path) {
  const store = document.getElementById('store');
  store.textContent = baseName(path);
  store.title = path;
  document.title = `${baseName(path)} · touchdown review`;
}

// Every two seconds: cheap for the server, quick enough for two people at one
// rig.
const kAskEvery_ms = 2000;

// changed(): the store has; back(): the server answers again.
export function watchServer({changed, back}) {
  let stamp = null, away = false, timer = null;
  async function ask() {
    try {
      const now = await get('/api/stamp');
      nameStore(now.store);
      const differs = stamp !== null && now.stamp !== stamp;
      stamp = now.stamp;
      if (away) {
        away = false;
        tell('The server is there again.');
        await back();
      }
      if (differs) await changed();
    } catch (error) {
      away = true;
      if (error.status !== 403) {
        tell(error.message, true);
      } else if (!document.getElementById('key')) {
        tell('', false, keyForm(() => {
          clearTimeout(timer);
          ask();
        }));
      }
    }
    timer = setTimeout(ask, kAskEvery_ms);
  }
  ask();
}

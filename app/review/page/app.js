// Which page is shown, and when it is shown anew.
import {element, get, rememberWho, tell} from './parts.js';
import {log} from './log.js';
import {overview} from './overview.js';
import {recordings} from './recordings.js';
import {report} from './report.js';
import {setup} from './setup.js';
import {trial} from './trial.js';

const pages = {log, overview, recordings, report, setup, trial};

// What the page shown wants: `changed` is called when the store has changed,
// `keys` gets key presses, `close` ends it.
let shown = null;
let stamp = null;

function pageOf(hash) {
  const [name, ...rest] = hash.replace(/^#\//, '').split('/');
  return {name: name || 'overview', rest: rest.map(decodeURIComponent)};
}

async function show() {
  const {name, rest} = pageOf(location.hash);
  const page = pages[name] ?? pages.overview;
  shown?.close?.();
  shown = null;
  tell('');
  for (const link of document.querySelectorAll('nav a')) {
    if (link.dataset.page === name) link.setAttribute('aria-current', 'page');
    else link.removeAttribute('aria-current');
  }
  const main = document.getElementById('main');
  // What was there stays until what is asked for is there.
  if (main.childElementCount === 0) {
    main.append(element('p', {text: 'Loading …'}));
  }
  try {
    shown = await page(main, ...rest) ?? {};
    if (document.activeElement === document.body) {
      main.focus({preventScroll: true});
    }
  } catch (error) {
    main.replaceChildren(element('p', {class: 'bad', role: 'alert',
                                       text: error.message}));
  }
}

// Every two seconds: cheap for the server, quick enough for two people at one
// rig.
const kAskEvery_ms = 2000;

async function watch() {
  try {
    const now = (await get('/api/stamp')).stamp;
    const changed = stamp !== null && now !== stamp;
    stamp = now;
    if (changed) await shown?.changed?.();
  } catch (error) {
    tell(error.message, true);
  }
  setTimeout(watch, kAskEvery_ms);
}

addEventListener('hashchange', show);
addEventListener('keydown', event => {
  const typing = event.target.closest?.('input, textarea, select');
  if (!typing && !event.ctrlKey && !event.metaKey && !event.altKey) {
    shown?.keys?.(event);
  }
});
rememberWho();
show();
watch();

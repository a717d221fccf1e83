// Which page is shown, and when it is shown anew.
import {element, rememberWho, turnNews} from './parts.js';
import {compare} from './compare.js';
import {log} from './log.js';
import {overview} from './overview.js';
import {recordings} from './recordings.js';
import {report} from './report.js';
import {watchServer} from './session.js';
import {setup} from './setup.js';
import {trial} from './trial.js';

const pages = {compare, log, overview, recordings, report, setup, trial};

// What the page shown wants: `changed` is called when the store has changed and
// returns how to tell of it; `keys` gets key presses, `close` ends it; `pending`
// says whether something was begun and not stored; `back`: the server answers
// again.
let shown = null;

function pageOf(hash) {
  const [name, ...rest] = hash.replace(/^#\//, '').split('/');
  return {name: name || 'overview', rest: rest.map(decodeURIComponent)};
}

// One page after the other: one that is slow to come does not overwrite the one
// that was asked for after it.
let asked = 0;
let turn = Promise.resolve();
function show() {
  const mine = ++asked;
  turn = turn.then(() => mine === asked ? showNow() : null);
  return turn;
}

async function showNow() {
  const {name, rest} = pageOf(location.hash);
  const page = pages[name] ?? pages.overview;
  shown?.close?.();
  shown = null;
  turnNews();
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

// What a page has to say of a change is said while it is shown: who has gone on
// meanwhile, by storing for one, reads what the next page says.
async function changed() {
  const mine = asked;
  const say = await shown?.changed?.();
  if (mine === asked) say?.();
}

addEventListener('hashchange', show);
addEventListener('keydown', event => {
  const typing = event.target.closest?.('input, textarea, select');
  if (!typing && !event.ctrlKey && !event.metaKey && !event.altKey) {
    shown?.keys?.(event);
  }
});
addEventListener('beforeunload', event => {
  if (shown?.pending?.()) event.preventDefault();
});
rememberWho();
show();
watchServer({
  changed,
  // A page that could not be shown is shown now; another goes on.
  back: () => shown ? shown.back?.() : show(),
});

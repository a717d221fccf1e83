// Small parts that every page uses: elements, requests, words for numbers.

// element('td', {class: 'num', text: '3'}, child, ...)
export function element(name, attributes = {}, ...children) {
  return fill(document.createElement(name), attributes, children);
}

export function svg(name, attributes = {}, ...children) {
  return fill(document.createElementNS('http://www.w3.org/2000/svg', name),
              attributes, children);
}

function fill(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (key === 'text') {
      node.textContent = value;
    } else if (key.startsWith('on')) {
      node.addEventListener(key.slice(2), value);
    } else {
      node.setAttribute(key, value === true ? '' : value);
    }
  }
  node.append(...children.filter(child => child !== null));
  return node;
}

// Trouble that the server told in words.
export class Refused extends Error {
  constructor(status, answer) {
    super(answer.error ?? `the server answered ${status}`);
    this.status = status;
    this.answer = answer;
  }
}

async function request(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new Refused(0, {error: 'the server does not answer; is ' +
        '`touchdown review` still running?'});
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(response.status, answer);
  return answer;
}

export function get(path, signal) { return request(path, {signal}); }

export function post(path, body, signal) {
  return request(path, {
    method: 'POST',
    headers: {'Content-Type': 'application/json'},
    body: JSON.stringify(body),
    signal,
  });
}

// "20.01 ± 0.05": u with two digits, the value to the same decimals.
export function withU(measured) {
  if (!measured) return '–';
  const {value, u} = measured;
  if (!(u > 0)) return String(Number(value.toFixed(4)));
  const decimals =
      Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(u))));
  return `${value.toFixed(decimals)} ± ${u.toFixed(decimals)}`;
}

export function degrees(value, decimals = 2) {
  return value === null || value === undefined ? '–' : value.toFixed(decimals);
}

// The last part of a path.
export function baseName(path) { return path.split('/').pop() || path; }

// Says something to everybody, also to who cannot see it appear; `more`:
// buttons behind it.
export function tell(text, bad = false, ...more) {
  const news = document.getElementById('news');
  news.replaceChildren(text, ...more);
  news.className = bad ? 'bad' : '';
}

// The same once the next page is shown.
let next = [''];
export function tellNext(text, ...more) { next = [text, false, ...more]; }
export function turnNews() {
  tell(...next);
  next = [''];
}

// Who the person at this page is; kept in this browser.
export function who() { return document.getElementById('who').value.trim(); }

export function rememberWho() {
  const field = document.getElementById('who');
  field.value = localStorage.getItem('touchdown.who') ?? '';
  field.addEventListener(
      'change', () => localStorage.setItem('touchdown.who', who()));
}

// A table of cells: text, or {text, class}, or a node.
export function table(caption, headings, rows, attributes = {}) {
  const cell = (name, content) => {
    if (content instanceof Node) return element(name, {}, content);
    if (typeof content === 'object' && content !== null) {
      return element(name, content);
    }
    return element(name, {text: content});
  };
  return element(
      'table', attributes,
      caption ? element('caption', {text: caption}) : null,
      element('thead', {}, element('tr', {}, ...headings.map(heading => {
        const th = cell('th', heading);
        th.setAttribute('scope', 'col');
        return th;
      }))),
      element('tbody', {}, ...rows.map(
          row => element('tr', {}, ...row.map(c => cell('td', c))))));
}

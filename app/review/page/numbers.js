// What was measured of one trial, in words: answer first, then its checks, then
// all numbers.
import {element, table} from './parts.js';

export function numbersTable(numbers) {
  const rows = numbers.quantities.map(
      q => [q.words, q.text ?? {text: q.absent, class: 'muted'}]);
  return table('Measured (± standard uncertainty)', ['number', 'value'], rows,
               {class: 'numbers'});
}

export function conditionsTable(conditions) {
  if (conditions.length === 0) return null;
  return table('As it was set', ['what', 'value'], conditions.map(
      c => [c.words, c.text]), {class: 'numbers'});
}

export function budget(name, lines) {
  if (lines.length === 0) return null;
  return table(`Where the uncertainty of the ${name} comes from`,
               ['source', {text: 'u, deg', class: 'num'}],
               lines.map(l => [l.source,
                               {text: l.u_deg.toFixed(4), class: 'num'}]));
}

export function said(numbers) {
  const p = numbers.p_bounce === null ? '' :
      `, P(bounce) ${numbers.p_bounce.toFixed(4)}`;
  return element('dl', {class: 'said'},
      element('dt', {text: `${numbers.angle_kind} angle`}),
      element('dd', {class: 'angle', text: numbers.angle}),
      element('dt', {text: 'state'}),
      element('dd', {class: 'state', text: numbers.state + p}),
      element('dt', {text: 'because'}),
      element('dd', {text: (numbers.state_reason || numbers.reason || '–')
                               .replaceAll('+-', '±')}));
}

// The checks that the program makes of its own answer. A word and a sign, not a
// colour alone.
const kChecks = {
  explained: 'outline explains what moves', size: 'size of the body',
  shape: 'all of the outline is seen to be the body',
  path: 'free flight beside the contact', restitution: 'restitution',
  gravity: 'gravity (scale, frame rate)',
};
const kVerdicts = {passed: '✓', doubtful: '!', refused: '✗', 'not made': '–'};

export function checksList(checks) {
  if (!checks || checks.length === 0) return null;
  return element('ul', {class: 'checks', 'aria-label': 'Checks of the answer'},
      ...checks.map(check => element('li', {
        class: check.verdict.replace(' ', '-'), 'data-check': check.name},
          element('span', {class: 'mark', 'aria-hidden': 'true',
                           text: kVerdicts[check.verdict] ?? '?'}),
          ` ${kChecks[check.name] ?? check.name}: ${check.verdict}`,
          check.reason ? element('span', {class: 'muted',
                                          text: ` (${check.reason})`}) : '')));
}

// Who said what of a trial, and what waits for a person.
import {element} from './parts.js';

export function historyList(history, shown, last, id, restore) {
  return element('ol', {class: 'history', reversed: true},
      ...[...history].reverse().map(h => element('li', {value: h.revision},
          h.revision === shown
              ? element('strong', {text: `revision ${h.revision} (shown)`})
              : element('a', {href: `#/trial/${id}/${h.revision}`,
                              text: `revision ${h.revision}`}),
          ` ${h.kind} by ${h.who}, ${h.when.slice(0, 19).replace('T', ' ')}` +
          ` UTC${h.why ? ': ' + h.why : ''}`,
          h.revision !== last && h.revision === shown
              ? element('button', {type: 'button', text:
                  'State this again', onclick: () => restore(h.revision)})
              : null,
          h.changes.length === 0 ? null
              : element('details', {},
                    element('summary', {text: `what changed: ` +
                        h.changes.slice(0, 3).map(c => c.words).join(', ') +
                        (h.changes.length > 3 ? ' …' : '')}),
                    element('ul', {}, ...h.changes.map(c => element('li', {text:
                        `${c.words}: ${c.from} → ${c.to}`})))))));
}

// An analysis that waits for a person; a person's correction stays in force.
export function proposalNote(data) {
  if (data.proposal === null) return '';
  const shown = data.row.revision === data.proposal;
  const changes = data.history.find(h => h.revision === data.proposal).changes;
  return element('div', {class: 'proposal'},
      element('p', {},
          shown ? 'This is an analysis that was proposed; the correction by a ' +
                  'person stays in force. "State this again" accepts it.'
                : 'A new analysis differs from this correction: ',
          shown ? '' : element('a', {
            href: `#/trial/${data.row.id}/${data.proposal}`,
            text: `look at revision ${data.proposal} and accept it there`})),
      element('ul', {}, ...changes.slice(0, 6).map(c => element('li', {text:
          `${c.words}: ${c.from} → ${c.to}`}))));
}

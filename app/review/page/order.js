// The trials in the order in which the list last showed them: next, previous.
import {get} from './parts.js';

let order = null;

export function keepOrder(ids) { order = ids; }

// {at, of, before, after} of a trial; a list that was never opened is asked
// for.
export async function neighbours(id) {
  order ??= (await get('/api/trials')).trials.map(t => t.id);
  const at = order.indexOf(id);
  return {at: at < 0 ? null : at + 1, of: order.length,
          before: at > 0 ? order[at - 1] : null,
          after: at >= 0 ? order[at + 1] ?? null : null};
}

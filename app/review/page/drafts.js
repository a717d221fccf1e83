// Corrections that were begun and not stored. They are kept in this browser, by
// store and trial, so that a closed tab or a restarted server loses none.

function key(store, trial) { return `touchdown.draft.${store}.${trial}`; }

// draft: {revision, asked, state, why}; when it was begun is added.
export function keepDraft(store, trial, draft) {
  try {
    localStorage.setItem(key(store, trial), JSON.stringify(
        {...draft, at: new Date().toISOString()}));
  } catch {
    // A browser that keeps nothing still corrects.
  }
}

export function dropDraft(store, trial) {
  localStorage.removeItem(key(store, trial));
}

export function draftOf(store, trial) {
  try {
    return JSON.parse(localStorage.getItem(key(store, trial)));
  } catch {
    return null;
  }
}

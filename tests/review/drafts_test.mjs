// What was begun is not lost: drafts, undo, a server that ends, a recording
// that was moved.
import assert from 'node:assert/strict';
import {mkdirSync, renameSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';

import {browser, frameShown, kCampaign, Lab, lab, requireClean, review, says,
        sitDown, startReview, useLaboratory} from './lab.mjs';

useLaboratory();

async function openTrial(page, origin = review.origin, id = lab.trial) {
  await page.goto(`${origin}/#/trial/${id}`);
  await frameShown(page, 89);
}

const draftsOf = page => page.evaluate(
    () => Object.keys(localStorage).filter(k => k.startsWith(
        'touchdown.draft.')).length);

test('a correction that was begun survives the tab, and is gone when stored',
     async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await page.selectOption('#state', 'slide');
  await page.fill('#why', 'half a rea');
  await page.waitForSelector('.changes tbody tr');
  // Whoever closes the tab is asked.
  const asked = page.waitForEvent('dialog');
  await page.close({runBeforeUnload: true});
  const dialog = await asked;
  assert.equal(dialog.type(), 'beforeunload');
  await dialog.accept();
  const again = await page.context().newPage();
  again.complaints = [];
  again.requested = [];
  again.setDefaultTimeout(60_000);
  await again.goto(`${review.origin}/`);
  await says(again, '.trials', 'a correction was begun');
  await openTrial(again);
  await says(again, '.draft', 'is back');
  assert.equal(await again.inputValue('#why'), 'half a rea');
  assert.equal(await again.inputValue('#state'), 'slide');
  await again.waitForSelector('.changes tbody tr');
  await again.click('text=Throw it away');
  assert.equal(await draftsOf(again), 0);
  assert.equal(await again.inputValue('#state'), '');
  requireClean(again, review);
  await again.context().close();
});

test('a draft of a trial that was revised meanwhile is offered and does not ' +
     'come by itself', async () => {
  const ada = await sitDown(browser, review, 'Ada');
  const grace = await sitDown(browser, review, 'Grace');
  await openTrial(ada);
  await ada.selectOption('#state', 'roll');
  await ada.waitForSelector('.changes tbody tr');
  await openTrial(grace);
  await grace.selectOption('#state', 'slide');
  await grace.fill('#why', 'it slides');
  await grace.click('text=Store this correction');
  await says(grace, '#news', 'Stored as revision');
  await ada.reload();
  await says(ada, '.draft', 'You began a correction of revision 1');
  assert.equal(await ada.inputValue('#state'), '');
  await ada.click('text=Take it over');
  assert.equal(await ada.inputValue('#state'), 'roll');
  await ada.waitForSelector('.changes tbody tr');
  await ada.click('text=Start over');
  for (const page of [ada, grace]) {
    requireClean(page, review);
    await page.context().close();
  }
});

test('a page that was left says nothing more', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  // The page asks what has changed while its own correction is being stored,
  // and is answered once the page that follows is shown.
  const signal = () => {
    let give;
    return {given: new Promise(resolve => give = resolve), give};
  };
  const asked = signal(), shown = signal();
  let first = true;
  await page.route(`**/api/trials/${lab.trial}`, async route => {
    const response = await route.fetch();
    if (first) {
      first = false;
      asked.give();
      await shown.given;
    }
    await route.fulfill({response});
  });
  await page.route('**/revisions', async route => {
    const response = await route.fetch();
    await asked.given;
    await route.fulfill({response});
  });
  const stored = `Stored as revision ${lab.show().history.length + 1}`;
  await page.selectOption('#state', 'stick');
  await page.fill('#why', 'it sticks');
  await page.click('text=Store this correction');
  await says(page, '#news', stored);
  // It asks again only once it has dealt with the late answer.
  const again = page.waitForRequest('**/api/stamp');
  shown.give();
  await again;
  assert.ok((await page.textContent('#news')).startsWith(stored));
  requireClean(page, review);
  await page.context().close();
});

test('of two tabs of one browser the second does not overwrite the first, and ' +
     'keeps what was begun', async () => {
  const first = await sitDown(browser, review, 'Ada');
  await openTrial(first);
  const second = await first.context().newPage();
  second.setDefaultTimeout(60_000);
  await openTrial(second);
  await second.selectOption('#state', 'stick');
  await second.fill('#why', 'of the second tab');
  await first.selectOption('#state', 'roll-slide');
  await first.fill('#why', 'of the first tab');
  await first.click('text=Store this correction');
  await says(first, '#news', 'Stored as revision');
  const count = lab.show().history.length;
  await second.click('text=Store this correction');
  await says(second, '.correct .bad', 'was made meanwhile');
  assert.equal(lab.show().history.length, count);
  assert.equal(await second.inputValue('#state'), 'stick');
  assert.equal(await second.inputValue('#why'), 'of the second tab');
  await second.click('text=Show what is there now');
  await says(second, '.draft', 'You began a correction');
  await second.click('text=Take it over');
  assert.equal(await second.inputValue('#why'), 'of the second tab');
  await second.click('text=Start over');
  requireClean(first, review);
  await first.context().close();
});

test('undo is a further revision that says the former values', async () => {
  const before = lab.show();
  const count = before.history.length;
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await page.selectOption('#state', 'roll');
  await page.fill('#why', 'wrong button');
  await page.click('text=Store this correction');
  await says(page, '#news', `Stored as revision ${count + 1}`);
  assert.equal(lab.list()[0].state, 'roll');
  assert.equal(await draftsOf(page), 0);
  await page.click('#news >> text=Undo');
  await says(page, '#news', `Undone: revision ${count + 2}`);
  const now = lab.show();
  assert.equal(now.history.length, count + 2);
  assert.deepEqual(now.contacts, before.contacts);
  assert.equal(now.history.at(-1).reason, `undo of revision ${count + 1}`);
  // Shown anew, with an empty form.
  await says(page, '.under', `revision ${count + 2} of`);
  // An exclusion, too.
  await page.fill('#why', 'by mistake');
  await page.click('text=Exclude this trial');
  await says(page, '.under', 'EXCLUDED');
  await page.click('#news >> text=Undo');
  await says(page, '#news', 'Undone');
  assert.equal(lab.list()[0].excluded, false);
  assert.equal(lab.show().history.length, count + 4);
  requireClean(page, review);
  await page.context().close();
});

test('a server that is killed and started anew takes its tabs back with its ' +
     'key, drafts and all', async () => {
  const own = new Lab();
  const first = await startReview(own.db);
  const page = await sitDown(browser, first, 'Ada');
  await openTrial(page, first.origin, own.trial);
  await page.selectOption('#state', 'slide');
  await page.fill('#why', 'begun before');
  await first.stop('SIGKILL');
  await says(page, '#news', 'does not answer');
  const second = await startReview(own.db);
  assert.equal(second.origin, first.origin);  // the store's own port
  assert.notEqual(second.token, first.token);
  await page.waitForSelector('#key');
  await page.fill('#key', 'wrong');
  await page.click('text=Go on');
  await says(page, '.key .bad', 'not its key');
  await page.fill('#key', second.address);
  await page.click('text=Go on');
  await says(page, '#news', 'there again');
  assert.equal(await page.inputValue('#why'), 'begun before');
  await page.click('text=Store this correction');
  await says(page, '.under', 'of 2');
  // Who reloads a tab of the old session is asked, too.
  await second.stop('SIGKILL');
  const third = await startReview(own.db);
  await page.goto(`${third.origin}/`);
  assert.match(await page.textContent('body'), /printed last/);
  await page.fill('input', third.address);
  await page.click('button');
  await page.waitForSelector('.trials tbody tr');
  assert.ok(!page.url().includes(third.token));
  assert.deepEqual(page.complaints, []);
  await page.context().close();
  await third.stop();
  own.remove();
});

test('a recording that was moved is found by what it is', async () => {
  const own = new Lab();
  const server = await startReview(own.db);
  const moved = join(own.folder, 'archive', 'deeper');
  mkdirSync(moved, {recursive: true});
  for (const ending of ['mraw', 'cihx']) {
    renameSync(own.clip.replace(/mraw$/, ending), join(moved, `x.${ending}`));
  }
  const page = await sitDown(browser, server, 'Ada');
  await page.goto(`${server.origin}/#/trial/${own.trial}`);
  await says(page, '.bad', 'No pictures');
  await page.fill('#moved', join(own.folder, 'nowhere'));
  await page.click('text=Look for it');
  await says(page, '#moved-said.bad', 'nowhere');
  await page.fill('#moved', join(own.folder, 'clips'));
  await page.click('text=Look for it');
  await says(page, '#moved-said', 'none of the 0 recordings');
  const before = own.show();
  await page.fill('#moved', own.folder);
  await page.click('text=Look for it');
  await frameShown(page, 89);
  await says(page, '#news', join(moved, 'x.mraw'));
  // Its place is all that changed.
  const now = own.show();
  assert.deepEqual(now.history, before.history);
  assert.equal(now.clip.path, join(moved, 'x.mraw'));
  requireClean(page, server);
  await page.context().close();
  await server.stop();
  own.remove();
});

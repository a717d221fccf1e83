// Recordings chosen from the folders that the server was given: analysed with
// progress, cancelled, killed, in two tabs.
import assert from 'node:assert/strict';
import {existsSync, readdirSync, renameSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';

import {browser, film, kCampaign, lab, picture, requireClean, review, says,
        sitDown, startReview, touchdown, useLaboratory} from './lab.mjs';

useLaboratory();

// Of some seconds: what is cancelled or killed is still being analysed.
const kLongFrames = 700;
before(() => {
  film(join(lab.clips, 'long'), shot => { shot.frames = kLongFrames; },
       '--format', 'mp4');
});

const kLong = 'long/sphere_20_deg.mp4';

async function openRecordings(page, at = review) {
  await page.goto(`${at.origin}/#/recordings`);
  await page.waitForSelector('form[aria-label="Analyse"]');
}

async function choose(page, name, campaign = kCampaign) {
  await page.selectOption('#clip-campaign', campaign);
  // By role: the queue's progress and cancel button carry the name, too.
  await page.getByRole('checkbox', {name, exact: true}).check();
}

async function send(page) {
  await page.click('form[aria-label="Analyse"] button.main');
}

async function analyse(page, name, campaign = kCampaign) {
  await choose(page, name, campaign);
  await send(page);
}

// The newest line of the queue, once it is in `state`.
function line(page, state) {
  return page.locator(`.queue li[data-state="${state}"]`).first();
}

test('a recording is chosen, analysed and logged with its set-point',
     async () => {
  lab.addCampaign('second look');
  const page = await sitDown(browser, review, 'Ada');
  await openRecordings(page);
  await page.fill('#clip-set_angle_deg', '95');
  await analyse(page, 'sphere_20_deg.mraw', 'second look');
  await says(page, '#clip-set_angle_deg-trouble', '0 .. 90');
  await page.fill('#clip-set_angle_deg', '20');
  await page.click('form[aria-label="Analyse"] button.main');
  await line(page, 'done').waitFor();
  await picture(page, 'recordings');
  const logged = lab.list().find(t => t.campaign === 'second look');
  assert.ok(Math.abs(logged.angle_deg.value - 20) < 0.2);
  assert.ok(Math.abs(logged.set_angle_deg - 20) < 1e-9);
  assert.match(logged.reason ?? lab.show(logged.id).history[0].reason, /Ada/);
  await line(page, 'done').locator('a').click();
  await says(page, '.under', 'second look');
  requireClean(page, review);
  await page.context().close();
});

test('an analysis shows its frames and is cancelled; nothing is stored',
     async () => {
  const before = lab.list().length;
  const page = await sitDown(browser, review, 'Ada');
  await openRecordings(page);
  await analyse(page, kLong);
  const running = line(page, 'running');
  await page.waitForFunction(
      n => new RegExp(`frame [1-9]\\d* of ${n}`).test(
          document.querySelector('.queue').textContent), kLongFrames);
  await picture(page, 'progress');
  await running.getByRole('button', {name: 'cancel'}).click();
  await line(page, 'cancelled').waitFor();
  await says(page, '.queue', 'nothing was stored');
  assert.equal(lab.list().length, before);
  requireClean(page, review);
  await page.context().close();
});

test('two tabs that analyse the same recording look at one analysis',
     async () => {
  lab.addCampaign('two tabs');
  const ada = await sitDown(browser, review, 'Ada');
  const grace = await sitDown(browser, review, 'Grace');
  await openRecordings(ada);
  await openRecordings(grace);
  await analyse(ada, kLong, 'two tabs');
  await line(ada, 'running').waitFor();
  await analyse(grace, kLong, 'two tabs');
  await says(grace, '.queue', 'two tabs');
  await says(ada, '.queue li[data-state="done"]', 'two tabs');
  await says(grace, '.queue li[data-state="done"]', 'two tabs');
  const logged = lab.list().filter(t => t.campaign === 'two tabs');
  assert.equal(logged.length, 1);
  assert.equal(lab.show(logged[0].id).history.length, 1);
  // Asked for again, the store has the answer.
  await analyse(grace, kLong, 'two tabs');
  await says(grace, '.queue', 'the store had this answer');
  assert.equal(lab.show(logged[0].id).history.length, 1);
  await ada.context().close();
  await grace.context().close();
});

test('a server that is killed while it analyses leaves nothing half written',
     async () => {
  lab.addCampaign('killed');
  const files = () => readdirSync(lab.folder, {recursive: true}).filter(
      f => !/-(wal|shm)$/.test(f)).sort();
  const before = [files(), lab.list().length];
  const doomed = await startReview(lab.db, '--recordings', lab.clips);
  const page = await sitDown(browser, doomed, 'Ada');
  await openRecordings(page, doomed);
  await analyse(page, kLong, 'killed');
  await says(page, '.queue', `of ${kLongFrames}`);
  await doomed.stop('SIGKILL');
  await page.context().close();
  assert.deepEqual([files(), lab.list().length], before);
  touchdown('db', 'check', '--db', lab.db);
  // And it can be asked for again.
  const again = await startReview(lab.db, '--recordings', lab.clips);
  const next = await sitDown(browser, again, 'Ada');
  await openRecordings(next, again);
  await analyse(next, kLong, 'killed');
  await line(next, 'done').waitFor();
  assert.equal(lab.list().length, before[1] + 1);
  await next.context().close();
  await again.stop();
});

test('a recording that vanished is told at its place, and what was typed ' +
     'stays', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openRecordings(page);
  await page.fill('#clip-set_angle_deg', '21');
  // Chosen while it was there: a list that is shown again has it no more.
  await choose(page, 'sphere_20_deg.mraw');
  const away = join(lab.folder, 'away.mraw');
  renameSync(lab.clip, away);
  try {
    await send(page);
    await says(page, 'form .bad', "must be one of the folders' recordings");
    assert.equal(await page.inputValue('#clip-set_angle_deg'), '21');
  } finally {
    renameSync(away, lab.clip);
  }
  assert.ok(existsSync(lab.clip));
  await page.context().close();
});

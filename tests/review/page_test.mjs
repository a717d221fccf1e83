// What a person does on the page, in a browser: look, correct, log, report.
import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';

import {browser, frameShown, kCampaign, lab, picture, requireClean, review,
        says, sitDown, useLaboratory} from './lab.mjs';

useLaboratory();

async function openTrial(page, id = lab.trial) {
  await page.goto(`${review.origin}/#/trial/${id}`);
  await page.waitForSelector('.picture');
}

test('the overview says what the trials say, and leads to a trial',
     async () => {
  const page = await sitDown(browser, review, 'Ada');
  await page.waitForSelector('.trials tbody tr');
  assert.equal(await page.locator('.trials tbody tr').count(), 1);
  await page.waitForSelector('.card .next');
  assert.match(await page.textContent('.card .next'), /deg/);
  assert.match(await page.textContent('.card'), /SIMULATED/);
  // The plot is there as a picture, with words for who cannot see it.
  const plot = page.locator('.card img');
  await plot.scrollIntoViewIfNeeded();
  await page.waitForFunction(
      () => document.querySelector('.card img').naturalWidth > 0);
  assert.match(await plot.getAttribute('alt'), /Plot of 1 trials/);
  assert.match(await page.textContent('main'), /Table 1 as it stands/);
  await page.evaluate(() => scrollTo(0, 0));
  await picture(page, 'overview');
  await page.click('.trials tbody a');
  await page.waitForSelector('.picture');
  requireClean(page, review);
  await page.context().close();
});

test('keys go through the frames', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await frameShown(page, 89);  // begins at the contact
  await page.locator('#main').focus();
  const press = async (key, frame) => {
    await page.keyboard.press(key);
    await frameShown(page, frame);
  };
  await press('ArrowRight', 90);
  await press('ArrowLeft', 89);
  await press('Shift+ArrowRight', 99);
  await press('Shift+ArrowLeft', 89);
  await press('Home', 0);
  await press('ArrowLeft', 0);
  await press('End', 129);
  await press('c', 89);
  assert.equal(await page.textContent('#frame'), 'frame 89 of 130');
  // Outline, ground, path, both flights and the contact are drawn.
  for (const part of ['outline', 'ground', 'path', 'before', 'after',
                      'approach']) {
    assert.equal(await page.locator(`.picture .${part}`).count(), 1, part);
  }
  await page.keyboard.press('z');
  await picture(page, 'contact');
  await page.keyboard.press('0');
  requireClean(page, review);
  await page.context().close();
});

test('the outline lies on the body', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await frameShown(page, 89);
  // Levels of the picture inside and outside of the drawn circle.
  const levels = await page.evaluate(async () => {
    const circle = document.querySelector('.outline');
    const at = name => Number(circle.getAttribute(name));
    const image = new Image();
    image.src = document.querySelector('.picture image').getAttribute('href');
    await image.decode();
    const canvas = document.createElement('canvas');
    canvas.width = image.naturalWidth;
    canvas.height = image.naturalHeight;
    const pen = canvas.getContext('2d');
    pen.drawImage(image, 0, 0);
    const level = (x, y) => pen.getImageData(Math.round(x), Math.round(y), 1,
                                             1).data[0];
    const [x, y, r] = [at('cx'), at('cy'), at('r')];
    return {inside: [level(x - r + 3, y), level(x + r - 3, y),
                     level(x, y - r + 3)],
            outside: [level(x - r - 3, y), level(x + r + 3, y),
                      level(x, y - r - 3)]};
  });
  // 15 % of full scale within, 65 % around (the scene's look).
  for (const level of levels.inside) assert.ok(level < 80, String(level));
  for (const level of levels.outside) assert.ok(level > 120, String(level));
  await page.context().close();
});

test('the ground line is moved, judged anew, stored with a reason, and the ' +
     'original is one click away', async () => {
  const before = lab.show().history;
  const page = await sitDown(browser, review, 'Grace');
  await openTrial(page);
  await frameShown(page, 89);
  const angle = await page.textContent('.said .angle');
  // The line is turned about its middle by 8 px over 511 px: 0.9 degrees.
  await page.locator('.handle').first().focus();
  for (let i = 0; i < 4; ++i) await page.keyboard.press('Shift+ArrowUp');
  await page.locator('.handle').last().focus();
  for (let i = 0; i < 4; ++i) await page.keyboard.press('Shift+ArrowDown');
  await page.waitForFunction(
      was => document.querySelector('.said .angle').textContent !== was, angle);
  await page.waitForSelector('.changes tbody tr');
  await picture(page, 'correct');
  // Not without a reason; what was done stays.
  await page.click('text=Store this correction');
  await says(page, '.correct .bad', 'reason');
  await page.fill('#why', 'the edge was not the board');
  await page.click('text=Store this correction');
  await says(page, '.under', 'of 2');
  const now = lab.show();
  assert.equal(now.history.length, before.length + 1);
  const last = now.history[now.history.length - 1];
  assert.equal(last.kind, 'corrected');
  assert.equal(last.author, 'Grace');
  assert.equal(last.reason, 'the edge was not the board');
  assert.match(JSON.stringify(now.document), /ground line through/);
  // The original: a link away, unchanged, and stated again by one button.
  await page.click('.history a:has-text("revision 1")');
  await page.waitForFunction(
      was => document.querySelector('.said .angle')?.textContent === was,
      angle);
  await page.click('text=State this again');
  await says(page, '.under', 'of 3');
  assert.equal(await page.textContent('.said .angle'), angle);
  await picture(page, 'history');
  requireClean(page, review);
  await page.context().close();
});

test('what is said of a correction stays when an earlier question is answered',
     async () => {
  const page = await sitDown(browser, review, 'Grace');
  await openTrial(page);
  await frameShown(page, 89);
  let answer;
  const held = new Promise(resolve => { answer = resolve; });
  await page.route('**/preview', async route => {
    await held;
    await route.continue();
  });
  await page.locator('.handle').first().focus();
  await page.keyboard.press('Shift+ArrowUp');
  await page.click('text=Store this correction');
  await says(page, '.correct .bad', 'reason');
  const answered = page.waitForResponse('**/preview');
  answer();
  await answered;
  await page.waitForSelector('.changes tbody tr');
  await says(page, '.correct .bad', 'reason');
  await page.context().close();
});

test('the contact is moved, an outline is nudged and left out, the state is ' +
     'set, a trial is excluded and taken back', async () => {
  const page = await sitDown(browser, review, 'Grace');
  await openTrial(page);
  await frameShown(page, 89);
  await page.locator('#main').focus();
  await page.keyboard.press('Shift+ArrowLeft');
  await frameShown(page, 79);
  await page.keyboard.press('t');
  await page.waitForSelector('.changes tbody tr');
  await page.click('text=Start over');
  await page.waitForSelector('.correct [data-changes="0"]');
  await page.click('button[aria-label="move the outline up"]');
  await page.waitForSelector('.changes tbody tr');
  await page.click('text=Leave it out');
  await page.waitForFunction(() => document.querySelectorAll(
      '.picture .outline').length === 0);
  await page.click('text=Start over');
  await page.waitForSelector('.correct [data-changes="0"]');
  await page.selectOption('#state', 'slide');
  await page.waitForSelector('.changes tbody tr');
  await page.fill('#why', 'seen by eye');
  const revision = lab.show().history.length;
  await page.click('text=Store this correction');
  await says(page, '.under', `revision ${revision + 1} of ${revision + 1}`);
  assert.match(await page.textContent('.said .state'), /^slide/);
  await page.fill('#why', 'somebody touched the camera');
  await page.click('text=Exclude this trial');
  await says(page, '.under', 'EXCLUDED: somebody touched the camera');
  assert.equal(lab.list()[0].excluded, true);
  await page.fill('#why', 'it was another one');
  await page.click('text=Include it again');
  await page.waitForFunction(() => !document.querySelector('.under')
      .textContent.includes('EXCLUDED'));
  assert.equal(lab.list()[0].excluded, false);
  requireClean(page, review);
  await page.context().close();
});

test('a trial is logged by hand; trouble stands beside its field and what ' +
     'was typed stays', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await page.goto(`${review.origin}/#/log`);
  await page.selectOption('#hand-campaign', kCampaign);
  await page.fill('#hand-angle_deg', '95');
  await page.fill('#hand-angle_u_deg', '0.5');
  await page.selectOption('#hand-state', 'bounce');
  const send = page.locator('form[aria-label="By hand"] button');
  await send.click();
  await page.waitForFunction(() => document.getElementById(
      'hand-angle_deg-trouble').textContent.includes('0 .. 90'));
  assert.equal(await page.inputValue('#hand-angle_deg'), '95');
  assert.equal(await page.inputValue('#hand-angle_u_deg'), '0.5');
  await picture(page, 'log');
  await page.fill('#hand-angle_deg', '31.5');
  await send.click();
  await page.waitForSelector('form[aria-label="By hand"] a');
  const logged = lab.list().find(t => t.origin === 'manual');
  assert.equal(logged.author, 'Ada');
  assert.ok(Math.abs(logged.angle_deg.value - 31.5) < 1e-9);
  requireClean(page, review);
  await page.context().close();
});

test('a report is built, viewed and downloaded', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await page.goto(`${review.origin}/#/report`);
  await page.click('text=Build the report');
  await page.waitForSelector('text=View table1.html');
  assert.ok(existsSync(join(lab.folder, 'report', 'table1.html')));
  const [report] = await Promise.all([
    page.context().waitForEvent('page'), page.click('text=View table1.html')]);
  await report.waitForLoadState();
  assert.match(await report.title(), /Table 1/);
  await picture(report, 'report');
  const [download] = await Promise.all([
    page.waitForEvent('download'), page.click('text=Download table1.csv')]);
  assert.equal(download.suggestedFilename(), 'table1.csv');
  requireClean(page, review);
  await page.context().close();
});

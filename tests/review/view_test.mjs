// A trial looked at: played, enlarged, drawn over, one after the other, two
// side by side.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {browser, frameShown, kCampaign, lab, picture, requireClean, review,
        says, sitDown, touchdown, useLaboratory} from './lab.mjs';

useLaboratory();

async function openTrial(page, id = lab.trial) {
  await page.goto(`${review.origin}/#/trial/${id}`);
  await frameShown(page, 89);
  await page.locator('#main').focus();
}

const frameOf = page => page.evaluate(
    () => Number(document.querySelector('.picture').dataset.frame));

// What of the recording is on the screen, px.
const boxOf = (page, selector) => page.evaluate(
    s => document.querySelector(s).getAttribute('viewBox').split(' ').map(
        Number), selector);

async function contactPoint(page) {
  return page.evaluate(() => {
    const mark = document.querySelector('.picture .touching');
    return ['cx', 'cy'].map(name => Number(mark.getAttribute(name)));
  });
}

test('it plays to the end, stops there, and begins again', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await page.selectOption('.playback select', '50');
  await page.locator('#main').focus();
  await page.keyboard.press(' ');
  await frameShown(page, 129);
  await page.waitForSelector('.playback[data-playing="false"]');
  await page.keyboard.press(' ');
  // From the first frame on: on a busy machine single frames are left out.
  await page.waitForFunction(
      () => Number(document.querySelector('.picture').dataset.shown) < 64);
  await page.keyboard.press(' ');
  await page.waitForSelector('.playback[data-playing="false"]');
  assert.ok(await frameOf(page) < 129);
  requireClean(page, review);
  await page.context().close();
});

test('the loop stays around the contact', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await page.selectOption('.playback select', '50');
  await page.locator('#main').focus();
  await page.keyboard.press('Home');
  await page.keyboard.press('l');
  // Every frame that is asked for, over three rounds.
  await page.evaluate(() => {
    globalThis.frames = [];
    new MutationObserver(() => frames.push(Number(
        document.querySelector('.picture').dataset.frame))).observe(
        document.querySelector('.picture'),
        {attributeFilter: ['data-frame']});
  });
  await page.keyboard.press(' ');
  await page.waitForFunction(
      () => frames.filter((f, i) => f < frames[i - 1]).length >= 3);
  const frames = await page.evaluate(() => globalThis.frames);
  assert.ok(Math.min(...frames) >= 77, String(frames));
  assert.ok(Math.max(...frames) <= 102, String(frames));
  assert.ok(frames.includes(89) && frames.includes(90));
  // Whoever leaves the page ends it.
  await page.goto(`${review.origin}/#/report`);
  await page.waitForSelector('text=Build the report');
  requireClean(page, review);
  await page.context().close();
});

test('z shows the contact, and the loupe holds it in every frame',
     async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  const [x, y] = await contactPoint(page);
  await page.keyboard.press('Home');
  await frameShown(page, 0);
  await page.keyboard.press('z');
  await frameShown(page, 89);
  const [left, top, wide, high] = await boxOf(page, '.picture');
  assert.ok(wide < 260, `${wide} px are seen`);
  assert.ok(Math.abs(left + wide / 2 - x) < 1 && Math.abs(top + high / 2 - y) < 1);
  const loupe = await boxOf(page, '.loupe');
  assert.ok(Math.abs(loupe[0] + loupe[2] / 2 - x) < 1e-6);
  assert.ok(Math.abs(loupe[1] + loupe[3] / 2 - y) < 1e-6);
  assert.ok(loupe[2] < wide / 2);
  await page.keyboard.press('ArrowRight');
  await frameShown(page, 90);
  assert.match(await page.getAttribute('.loupe image', 'href'), /frames\/90$/);
  requireClean(page, review);
  await page.context().close();
});

test('what is drawn can be left out, contrast and gamma be set; the next ' +
     'trial keeps both', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  for (const part of ['outline', 'ground', 'path', 'before', 'after',
                      'approach']) {
    const drawn = page.locator(`.picture .${part}`);
    const box = page.locator(`.legend input[value="${part}"]`);
    const shown = () => drawn.evaluate(e => getComputedStyle(e).display);
    assert.notEqual(await shown(), 'none', part);
    await box.uncheck();
    assert.equal(await shown(), 'none', part);
    await box.check();
    assert.notEqual(await shown(), 'none', part);
  }
  await page.locator('.legend input[value="path"]').uncheck();
  const filterOf = () => page.locator('.picture image').evaluate(
      e => getComputedStyle(e).filter);
  assert.equal(await filterOf(), 'none');
  await page.locator('#look-contrast').fill('3');
  assert.match(await filterOf(), /look/);
  assert.equal(await page.getAttribute('#look feFuncR[type="linear"]', 'slope'),
               '3');
  await page.locator('#look-gamma').fill('2');
  assert.equal(await page.getAttribute('#look feFuncR[type="gamma"]',
                                       'exponent'), '0.5');
  await page.goto(`${review.origin}/#/report`);
  await page.waitForSelector('text=Build the report');
  await openTrial(page);
  assert.match(await filterOf(), /look/);
  assert.equal(await page.isChecked('.legend input[value="path"]'), false);
  await page.click('text=As recorded');
  assert.equal(await filterOf(), 'none');
  await page.locator('.legend input[value="path"]').check();
  requireClean(page, review);
  await page.context().close();
});

test('the bounce height is a line in the plot of the gap; the checks stand ' +
     'beside the answer, in words', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  // 2 % of a sphere of 40 mm.
  assert.equal(await page.textContent('.plot text.across'),
               'bounce height 0.80');
  const checks = await page.locator('.checks li').evaluateAll(
      all => all.map(li => [li.dataset.check, li.textContent]));
  const of = Object.fromEntries(checks);
  assert.deepEqual(Object.keys(of).sort(),
                   ['explained', 'gap', 'gravity', 'path', 'restitution',
                    'shape', 'size']);
  const document = lab.show().document;
  for (const {name, verdict} of document.checks) {
    assert.ok(of[name].includes(verdict), `${name}: ${of[name]}`);
  }
  await page.click('text=All numbers');
  const words = await page.textContent('.numbers');
  assert.match(words, /approach angle, deg/);
  assert.doesNotMatch(words, /_|\brad\b|omega/);
  requireClean(page, review);
  await page.context().close();
});

test('two trials: next and previous, side by side from touchdown, and the ' +
     'trajectory as a file', async () => {
  lab.addCampaign('again');
  touchdown('analyze', lab.clip, '--db', lab.db, '--campaign', 'again');
  const second = lab.list().find(t => t.campaign === 'again').id;
  const page = await sitDown(browser, review, 'Ada');
  await openTrial(page);
  await says(page, '.beside', 'of 2');
  const first_place = (await page.textContent('.beside')).includes('1 of 2');
  await page.keyboard.press(first_place ? 'n' : 'p');
  await page.waitForURL(`**/#/trial/${second}`);
  await page.goto(`${review.origin}/#/`);
  await page.waitForSelector('.trials tbody tr');
  for (const box of await page.locator('.trials tbody input').all()) {
    await box.check();
  }
  await page.click('text=Show these two side by side');
  await page.waitForFunction(() => document.querySelectorAll(
      '.side .picture[data-shown="89"]').length === 2);  // nearest to 89.4
  await page.keyboard.press('ArrowLeft');
  await page.waitForFunction(() => document.querySelectorAll(
      '.side .picture[data-shown="88"]').length === 2);
  assert.equal(await page.textContent('#frame'), '−0.50 ms');  // 2000 frames/s
  await picture(page, 'compare');
  requireClean(page, review);
  await openTrial(page, second);
  const [download] = await Promise.all([
    page.waitForEvent('download'), page.click('text=Trajectory as CSV')]);
  const csv = readFileSync(await download.path(), 'utf8').trim().split('\r\n');
  assert.equal(csv[0], 'frame,time_s,x_mm,y_mm,gap_mm,face_angle_deg');
  const path = lab.show(second).document.path;
  assert.equal(csv.length, path.rows.length + 1);
  assert.equal(csv[1].split(',').slice(0, 5).join(' '),
               path.rows[0].split(' ').slice(0, 5).join(' '));
  await page.context().close();
});

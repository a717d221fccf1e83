// Two people at once, a thousand trials, and who may not ask.
import assert from 'node:assert/strict';
import http from 'node:http';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';

import {browser, frameShown, kCampaign, lab, picture, requireClean, review,
        says, sitDown, touchdown, useLaboratory}
    from './lab.mjs';

useLaboratory();

async function openTrial(page) {
  await page.goto(`${review.origin}/#/trial/${lab.trial}`);
  await frameShown(page, 89);
}

test('two people see each other\'s changes and never overwrite one another',
     async () => {
  const ada = await sitDown(browser, review, 'Ada');
  const grace = await sitDown(browser, review, 'Grace');
  await openTrial(ada);
  await openTrial(grace);
  // Both have something unsaved.
  await ada.selectOption('#state', 'slide');
  await ada.waitForSelector('.changes tbody tr');
  await grace.selectOption('#state', 'roll');
  await grace.waitForSelector('.changes tbody tr');
  await ada.fill('#why', 'it slides');
  await ada.click('text=Store this correction');
  await says(ada, '.under', 'of 2');
  await grace.fill('#why', 'it rolls');
  await grace.click('text=Store this correction');
  await says(grace, '.correct .bad', 'revision 2 was made meanwhile');
  assert.match(await grace.textContent('.correct .bad'), /Ada: it slides/);
  assert.equal(await grace.inputValue('#why'), 'it rolls');  // nothing lost
  await picture(grace, 'conflict');
  assert.equal(lab.show().history.length, 2);
  await grace.click('text=Show what is there now');
  await says(grace, '.under', 'of 2');
  // Ada, who has nothing unsaved, sees what Grace does without asking.
  await grace.selectOption('#state', 'roll');
  await grace.waitForSelector('.changes tbody tr');
  await grace.fill('#why', 'it rolls');
  await grace.click('text=Store this correction');
  await says(ada, '.under', 'of 3');
  assert.match(await ada.textContent('.said .state'), /^roll/);
  requireClean(ada, review);
  await ada.context().close();
  await grace.context().close();
});

// Without a browser: fields of the header as one likes.
function ask(headers, {path = '/api/trials', method = 'GET', body} = {}) {
  const {port} = new URL(review.origin);
  return new Promise((resolve, reject) => {
    const request = http.request(
        {host: '127.0.0.1', port, path, method, headers}, response => {
          let text = '';
          response.on('data', part => text += part);
          response.on('end', () => resolve({status: response.statusCode, text,
                                            headers: response.headers}));
        });
    request.on('error', reject);
    request.end(body);
  });
}

test('nobody gets in without the key, under another name, or from another ' +
     'page', async () => {
  const key = {'X-Touchdown-Token': review.token};
  const host = new URL(review.origin).host;
  assert.equal((await ask({Host: host, ...key})).status, 200);
  assert.equal((await ask({Host: host})).status, 403);
  assert.equal((await ask({Host: host, 'X-Touchdown-Token': 'x'})).status, 403);
  assert.equal((await ask({Host: 'evil.example', ...key})).status, 403);
  assert.equal((await ask({Host: host, Origin: 'http://evil.example',
                           ...key})).status, 403);
  assert.equal((await ask({Host: host, 'Sec-Fetch-Site': 'cross-site',
                           ...key})).status, 403);
  assert.equal((await ask({Host: host}, {path: '/?token=wrong'})).status, 403);
  // What changes something must be JSON: no form of another page sends that.
  const form = {'Content-Type': 'text/plain', ...key};
  assert.equal((await ask({Host: host, ...form},
                          {path: '/api/report', method: 'POST', body: '{}'}))
                   .status, 415);
  assert.equal(lab.list().length, 1);
});

test('a browser with a wrong key is told what to do, and another page cannot ' +
     'ask in its name', async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(review.origin + '/?token=00000000');
  assert.match(await page.textContent('body'), /printed last/);
  await page.goto(review.address);  // now this browser has the key
  await page.waitForSelector('.trials');
  assert.ok(!page.url().includes(review.token));
  assert.equal(await page.evaluate(() => document.cookie), '');
  // A page of another origin in the same browser.
  const other = http.createServer((request, response) => {
    response.setHeader('Content-Type', 'text/html');
    response.end('<p>another page</p>');
  });
  await new Promise(resolve => other.listen(0, '127.0.0.1', resolve));
  const foreign = await context.newPage();
  await foreign.goto(`http://127.0.0.1:${other.address().port}/`);
  const stolen = await foreign.evaluate(async origin => {
    try {
      return (await fetch(origin + '/api/trials', {credentials: 'include'}))
          .status;
    } catch (error) {
      return 'refused';
    }
  }, review.origin);
  assert.equal(stolen, 'refused');
  const written = await foreign.evaluate(async origin => {
    await fetch(origin + '/api/report', {method: 'POST', mode: 'no-cors',
        credentials: 'include', body: '{}'}).catch(() => {});
    return true;
  }, review.origin);
  assert.ok(written);
  assert.equal((await ask({Host: new URL(review.origin).host,
                           'X-Touchdown-Token': review.token},
                          {path: '/report/table1.html'})).status, 404);
  await context.close();
  await new Promise(resolve => other.close(resolve));
});

test('a file on the disk leads the browser in', async () => {
  // As the program starts it: a navigation that another page began.
  const file = join(lab.folder, 'enter.html');
  writeFileSync(file, `<meta http-equiv="refresh" content="0; url=${
      review.address}">`);
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto('file://' + file);
  await page.waitForSelector('.trials');
  assert.equal(page.url(), review.origin + '/');
  await context.close();
});

test('every answer forbids scripts in the page and loads from elsewhere',
     async () => {
  const host = new URL(review.origin).host;
  for (const path of ['/', '/api/trials', '/nothing']) {
    const {headers} = await ask({Host: host,
                                 'X-Touchdown-Token': review.token}, {path});
    assert.match(headers['content-security-policy'], /default-src 'none'/);
    assert.doesNotMatch(headers['content-security-policy'], /unsafe/);
    assert.equal(headers['x-content-type-options'], 'nosniff');
  }
});

test('a list of a thousand trials, those that need a look first',
     async () => {
  const lines = ['campaign,body_kind,angle_kind,origin,state,' +
                 'approach_angle_deg,approach_angle_u_deg'];
  for (let i = 0; i < 1000; ++i) {
    const angle = 5 + i % 40;
    const state = i % 100 === 7 ? 'undecided' : angle > 14 ? 'bounce' : 'slide';
    lines.push(`${kCampaign},sphere,approach,manual,${state},${angle},0.5`);
  }
  const csv = join(lab.folder, 'many.csv');
  writeFileSync(csv, lines.join('\r\n') + '\r\n');
  const page = await sitDown(browser, review, 'Ada');
  await page.waitForSelector('.trials tbody tr');
  touchdown('import', csv, '--db', lab.db, '--by', 'Ada');
  // It appears without being asked for.
  await page.waitForFunction(
      () => document.querySelectorAll('.trials tbody tr').length === 1001);
  const first = page.locator('.trials tbody tr').first();
  assert.match(await first.textContent(), /no contact|undecided/);
  await page.fill('#filter', 'undecided');
  await page.waitForFunction(
      () => document.querySelectorAll('.trials tbody tr:not([hidden])')
                .length === 10);
  await picture(page, 'thousand');
  await page.fill('#filter', '');
  await page.locator('.trials tbody a').first().focus();
  await page.keyboard.press('ArrowDown');
  assert.ok(await page.evaluate(
      () => document.activeElement ===
          document.querySelectorAll('.trials tbody a')[1]));
  requireClean(page, review);
  await page.context().close();
});

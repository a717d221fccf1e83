// For everybody: axe-core finds nothing serious on any page, at the size of a
// small laptop and of a tablet, and nothing needs a mouse.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {test} from 'node:test';

import {browser, frameShown, lab, picture, review, sitDown, useLaboratory}
    from './lab.mjs';

const axe = readFileSync(
    createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

useLaboratory();

async function allFindings(page) {
  await page.evaluate(axe);
  const {violations} = await page.evaluate(() => globalThis.axe.run());
  return violations;
}

function told(violations) {
  return violations.map(
      v => `${v.id}: ${v.nodes.map(n => n.html).join(' | ')}`);
}

async function findings(page) {
  return told((await allFindings(page)).filter(
      v => v.impact === 'serious' || v.impact === 'critical'));
}

// At the side.
async function requireNothingCutOff(page) {
  assert.ok(await page.evaluate(
      () => document.documentElement.scrollWidth <= innerWidth));
}

const kViews = {laptop: [1280, 720, 'light'], tablet: [820, 1180, 'light'],
                dark: [1280, 720, 'dark'], phone: [390, 844, 'light'],
                wide: [1920, 1080, 'light']};

for (const [name, [width, height, colorScheme]] of Object.entries(kViews)) {
  test(`axe-core has nothing serious to say (${name})`, async () => {
    const page = await sitDown(browser, review, 'Ada', {width, height});
    await page.emulateMedia({colorScheme});
    await page.waitForSelector('.card .next');
    assert.deepEqual(await findings(page), []);
    await picture(page, `overview-${name}`);
    await requireNothingCutOff(page);
    await page.goto(`${review.origin}/#/trial/${lab.trial}`);
    await frameShown(page, 89);
    assert.deepEqual(await findings(page), []);
    await picture(page, `trial-${name}`);
    await requireNothingCutOff(page);
    await page.goto(`${review.origin}/#/compare/${lab.trial}/${lab.trial}`);
    await page.waitForSelector('.side .picture[data-shown]');
    assert.deepEqual(await findings(page), []);
    await picture(page, `compare-${name}`);
    await requireNothingCutOff(page);
    await page.goto(`${review.origin}/#/log`);
    await page.waitForSelector('form');
    assert.deepEqual(await findings(page), []);
    await page.goto(`${review.origin}/#/report`);
    await page.waitForSelector('text=Build the report');
    assert.deepEqual(await findings(page), []);
    await page.context().close();
  });
}

const kReportViews = {wide: [1280, 'light'], dark: [1280, 'dark'],
                      phone: [390, 'light']};

for (const [name, [width, colorScheme]] of Object.entries(kReportViews)) {
  test(`axe-core has nothing to say of the report (${name})`, async () => {
    const page = await sitDown(browser, review, 'Ada');
    await page.goto(`${review.origin}/#/report`);
    await page.click('text=Build the report');
    await page.waitForSelector('text=View table1.html');
    await page.setViewportSize({width, height: 900});
    await page.emulateMedia({colorScheme});
    await page.goto(`file://${join(lab.folder, 'report', 'table1.html')}`);
    assert.deepEqual(told(await allFindings(page)), []);
    await picture(page, `report-${name}`);
    // Wide tables scroll by themselves, the page does not.
    assert.ok(await page.evaluate(
        () => document.documentElement.scrollWidth <= innerWidth));
    await page.context().close();
  });
}

test('everything is reached by the Tab key', async () => {
  const page = await sitDown(browser, review, 'Ada');
  await page.goto(`${review.origin}/#/trial/${lab.trial}`);
  await frameShown(page, 89);
  await page.locator('.skip').focus();
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => {
      const e = document.activeElement;
      return e.id || e.getAttribute('aria-label') || e.textContent;
    }));
  }
  for (const wanted of ['scrub', 'state', 'why', 'Store this correction',
                        'move the outline left', 'Exclude this trial']) {
    assert.ok(reached.has(wanted), wanted);
  }
  assert.ok([...reached].some(r => r.startsWith('ground line, left point')));
  await page.context().close();
});

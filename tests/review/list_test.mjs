// The list: sorted, filtered, with names of any length.
import assert from 'node:assert/strict';
import {mkdirSync, renameSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';

import {browser, kCampaign, lab, picture, requireClean, review, says, sitDown,
        touchdown, useLaboratory} from './lab.mjs';

useLaboratory();

const kLong = 'a_very_long_name_of_a_recording_that_somebody_gave_it_' +
    'in_the_laboratory_and_that_has_no_blank_at_all_0123456789';

const shownNames = page => page.locator(
    '.trials tbody tr:not([hidden]) .name').allTextContents();

test('the list is sorted by any column, filtered, and holds a long name',
     async () => {
  // Three by hand, and the recording analysed again under a long name.
  const csv = join(lab.folder, 'hand.csv');
  writeFileSync(csv, [
    'campaign,body_kind,angle_kind,origin,state,approach_angle_deg,' +
        'approach_angle_u_deg,set_angle_deg',
    `${kCampaign},sphere,approach,manual,slide,9,0.5,10`,
    `${kCampaign},sphere,approach,manual,bounce,31,0.5,30`,
    `${kCampaign},sphere,approach,manual,undecided,12,0.5,20`].join('\r\n') +
        '\r\n');
  touchdown('import', csv, '--db', lab.db, '--by', 'Ada');
  lab.addCampaign('long');
  const folder = join(lab.folder, 'long');
  mkdirSync(folder);
  for (const ending of ['mraw', 'cihx', 'truth.json']) {
    renameSync(lab.clip.replace(/mraw$/, ending),
                 join(folder, `${kLong}.${ending}`));
  }
  touchdown('analyze', join(folder, `${kLong}.mraw`), '--db', lab.db,
            '--campaign', 'long');
  const page = await sitDown(browser, review, 'Ada');
  await page.waitForSelector('.trials tbody tr');
  assert.equal(await page.textContent('#store'), 'lab.db');
  assert.equal(await page.getAttribute('#store', 'title'), lab.db);

  const column = async n => (await page.locator(
      `.trials tbody tr:not([hidden]) td:nth-child(${n})`).allTextContents());
  await page.click('.sort:has-text("set, deg")');
  assert.deepEqual(await column(6), ['10.00', '20.00', '30.00', '–', '–']);
  assert.equal(await page.getAttribute('th:has-text("set, deg")', 'aria-sort'),
               'ascending');
  await page.click('.sort:has-text("set, deg")');
  assert.deepEqual(await column(6), ['30.00', '20.00', '10.00', '–', '–']);
  await page.selectOption('select[data-filter="origin"]', 'manual');
  assert.equal((await shownNames(page)).length, 3);
  await page.selectOption('select[data-filter="state"]', 'slide');
  assert.deepEqual(await column(6), ['10.00']);
  // Coming back, the list is as it was left; next and previous follow it.
  await page.click('.trials tbody tr:not([hidden]) a');
  await says(page, '.beside', '1 of 1');
  await page.goBack();
  await page.waitForSelector('.trials tbody tr:not([hidden])');
  assert.deepEqual(await column(6), ['10.00']);
  for (const key of ['origin', 'state']) {
    await page.selectOption(`select[data-filter="${key}"]`, '');
  }

  // Pictures of what is in sight; a trial by hand has none.
  await page.waitForFunction(() => [...document.querySelectorAll(
      '.thumbnail')].filter(i => i.naturalWidth === 96).length === 2);
  await picture(page, 'list');
  for (const [name, width] of [['narrow', 390], ['wide', 1920]]) {
    await page.setViewportSize({width, height: 900});
    assert.ok(await page.evaluate(
        () => document.documentElement.scrollWidth <= innerWidth), name);
  }
  requireClean(page, review);
  await page.context().close();
});

// From an empty folder with one clip to the first trial's answer on the page,
// as a new user goes it: commands and clicks are counted. Then what may be told
// wrong: the body, its size.
import assert from 'node:assert/strict';
import {existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';

import {film, frameShown, openBrowser, picture, requireClean, says, sitDown,
        startReview, touchdown} from './lab.mjs';

const axe = readFileSync(
    createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

let browser;
before(async () => { browser = await openBrowser(); });
after(async () => { await browser?.close(); });

// A folder with one clip and nothing else.
async function newcomer(run) {
  const folder = mkdtempSync(join(tmpdir(), 'touchdown-new-'));
  film(folder);
  // A recording has no truth beside it.
  rmSync(join(folder, 'sphere_20_deg.truth.json'));
  const db = join(folder, 'lab.db');
  const review = await startReview(db, '--recordings', folder);
  try {
    await run(review, db, folder);
  } finally {
    await review.stop();
    rmSync(folder, {recursive: true});
  }
}

const list = db => JSON.parse(touchdown('list', '--db', db, '--json')).trials;

// Clicks on the picture at points of the recording, px.
async function mark(page, ...points) {
  for (const [x, y] of points) {
    const at = await page.evaluate(([px, py]) => {
      const node = document.querySelector('.picture');
      const p = new DOMPoint(px, py).matrixTransform(node.getScreenCTM());
      return [p.x, p.y];
    }, [x, y]);
    await page.mouse.click(...at);
  }
}

async function ready(page) {
  await page.waitForSelector('form[aria-label="New campaign"]');
  await frameShown(page, 0);
}

test('from an empty folder to the first answer in at most 8 commands or ' +
     'clicks', async () => {
  await newcomer(async (review, db) => {
    const begun = performance.now();
    const acts = ['touchdown review --db lab.db --recordings .'];
    const act = async (what, done) => { acts.push(what); await done; };
    const page = await sitDown(browser, review, '');
    acts.push('open the address that it prints');
    await ready(page);
    await says(page, 'main', 'There is no store');
    assert.ok(!existsSync(db));
    await act('type the name', page.fill('#setup-name', 'asphalt, 40 mm'));
    await act('type the diameter', page.fill('#setup-diameter_mm', '40'));
    await act('press Analyse', page.getByRole('button', {name: 'Analyse'}).click());
    await says(page, '.answer .state', 'bounce');
    // As it was thrown: rendered to fall 8.15 mm from 12.67 deg.
    assert.match(await page.textContent('.answer .angle'),
                 /^19\.[89]\d+ ± 0\.\d+ deg/);
    assert.ok(!existsSync(db));  // shown before anything is stored
    await page.setViewportSize({width: 1280, height: 1060});
    await picture(page, 'first-answer');
    await act('type who you are', page.fill('#who', 'Ada'));
    await act('press Keep it', page.getByRole('button', {name: 'Keep it'}).click());
    await says(page, '.under', 'asphalt, 40 mm');
    await says(page, '.said .state', 'bounce');
    const seconds = (performance.now() - begun) / 1000;
    console.log(`${acts.length} commands or clicks (${acts.join('; ')}), ` +
                `${seconds.toFixed(1)} s`);
    assert.ok(acts.length <= 8, acts.join('; '));
    const [trial] = list(db);
    assert.ok(Math.abs(trial.angle_deg.value - 20) < 0.2);
    touchdown('db', 'check', '--db', db);
    requireClean(page, review);
    await page.context().close();
  });
});

test('scale and ground are two clicks each, and hold for the next recording',
     async () => {
  await newcomer(async (review, db, folder) => {
    const page = await sitDown(browser, review, 'Ada');
    await ready(page);
    await page.fill('#setup-name', 'marked');
    await page.fill('#setup-diameter_mm', '40');
    await page.click('text=Mark two points of known distance');
    await mark(page, [100, 100], [500, 100]);
    await says(page, 'form', '400.');  // px apart, within a pixel
    await page.fill('#setup-length_mm', '400');
    await page.click('text=Mark two points of the ground');
    await mark(page, [40, 330], [600, 330]);
    await picture(page, 'marked');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '.answer', 'as marked');
    await page.getByRole('button', {name: 'Keep it'}).click();
    await says(page, '.under', 'marked');
    const [trial] = list(db);
    const document = JSON.parse(touchdown('show', trial.id, '--db', db, '--json'));
    const camera = (document.document ?? document.analysis ?? document);
    assert.ok(JSON.stringify(camera).includes('"calibration"'));
    assert.ok(Math.abs(trial.angle_deg.value - 20) < 0.3);
    // The next one of the same camera.
    film(join(folder, 'second'), shot => { shot.thrown.start.gap_mm = 8.25; });
    await page.goto(`${review.origin}/#/recordings`);
    await says(page, 'form[aria-label="Analyse"]', 'ground as marked');
    await page.getByRole('checkbox', {name: 'second/sphere_20_deg.mraw',
                                      exact: true}).check();
    await page.click('form[aria-label="Analyse"] button.main');
    await page.locator('.queue li[data-state="done"]').first().waitFor();
    assert.equal(list(db).length, 2);
    requireClean(page, review);
    await page.context().close();
  });
});

test('a body that is told wrong is seen in the checks, before anything is ' +
     'stored', async () => {
  await newcomer(async (review, db) => {
    const page = await sitDown(browser, review, 'Ada');
    await ready(page);
    // What is missing is told at its place.
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '#setup-name-trouble', 'is missing');
    await page.fill('#setup-name', 'wrong');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '#setup-diameter_mm-trouble', 'is missing');
    // 20 % off, beside a scale that is known.
    await page.click('text=Mark two points of known distance');
    await mark(page, [100, 100], [500, 100]);
    await page.fill('#setup-length_mm', '400');
    await page.fill('#setup-diameter_mm', '48');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '.checks', 'no: so no answer is given');
    await says(page, '.answer .angle', 'absent');
    await picture(page, 'wrong-size');
    // A block for a sphere.
    await page.selectOption('#setup-body', 'rectangle');
    await page.fill('#setup-sides_mm', '60x20');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '.answer', 'looks like a sphere, not like a rectangle');
    assert.equal(await page.locator('.picture .drawn.path').count(), 0);
    await page.waitForSelector('text=Keep it without an answer');
    await picture(page, 'wrong-body');
    assert.ok(!existsSync(db));
    // As it was.
    await page.selectOption('#setup-body', 'sphere');
    await page.fill('#setup-diameter_mm', '40');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '.answer .angle', '19.');
    assert.equal(await page.locator('.checks .bad').count(), 0);
    requireClean(page, review);
    await page.context().close();
  });
});

test('a test is cancelled, and another can be made', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'touchdown-new-'));
  film(folder, shot => { shot.frames = 700; }, '--format', 'mp4');
  const db = join(folder, 'lab.db');
  const review = await startReview(db, '--recordings', folder);
  const page = await sitDown(browser, review, 'Ada');
  await ready(page);
  await page.fill('#setup-name', 'long');
  await page.fill('#setup-diameter_mm', '40');
  await page.fill('#setup-fps', '2000');
  await page.getByRole('button', {name: 'Analyse'}).click();
  await says(page, 'form', 'of 700');
  await page.getByRole('button', {name: 'cancel'}).click();
  await says(page, 'form', 'nothing was stored');
  assert.ok(!existsSync(db));
  await page.getByRole('button', {name: 'Analyse'}).click();
  await says(page, '.answer .angle', '19.');
  requireClean(page, review);
  await page.context().close();
  await review.stop();
  rmSync(folder, {recursive: true});
});

// Pictures of a chessboard of 7 x 5 inner corners, as a browser draws it in
// space: a camera without distortion.
async function photographBoard(folder) {
  mkdirSync(folder);
  const page = await browser.newPage({viewport: {width: 640, height: 400}});
  for (let i = 0; i < 9; ++i) {
    const place = `translate(${(i % 3 - 1) * 110}px, ` +
        `${(Math.floor(i / 3) - 1) * 60}px)`;
    const tilt = `rotateX(${[-32, 25, 8][i % 3]}deg) ` +
        `rotateY(${[28, -12, -35][Math.floor(i / 3)]}deg) rotate(${3 * i}deg)`;
    const squares = Array.from({length: 48}, (_, n) =>
      `<i style="background:${(n + Math.floor(n / 8)) % 2 ? '#222' : '#eee'}">` +
      '</i>').join('');
    await page.setContent(`<style>
      body { margin: 0; height: 400px; background: #eee; perspective: 700px;
             display: grid; place-items: center; overflow: hidden; }
      div { display: grid; grid-template-columns: repeat(8, 32px);
            grid-auto-rows: 32px; } </style>
      <div style="transform: ${place} ${tilt}">${squares}</div>`);
    await page.screenshot({path: join(folder, `${i}.png`)});
  }
  await page.close();
}

test('a lens is made from a folder of board pictures', async () => {
  await newcomer(async (review, db, folder) => {
    await photographBoard(join(folder, 'board'));
    const page = await sitDown(browser, review, 'Ada');
    await ready(page);
    await page.click('text=A lens, from pictures of a board');
    const make = page.getByRole('button', {name: 'Make the lens'});
    await make.click();
    await says(page, '#setup-board-trouble', 'is missing');
    await page.fill('#setup-board', 'chessboard:7x5:20mm');
    await make.click();
    await says(page, 'form', 'over 9 pictures');
    await page.fill('#setup-name', 'with a lens');
    await page.fill('#setup-diameter_mm', '40');
    await page.getByRole('button', {name: 'Analyse'}).click();
    await says(page, '.answer .angle', '19.');
    await picture(page, 'lens');
    await page.getByRole('button', {name: 'Keep it'}).click();
    await says(page, '.under', 'with a lens');
    await page.goto(`${review.origin}/#/recordings`);
    await says(page, 'form[aria-label="Analyse"]', 'lens undone');
    requireClean(page, review);
    await page.context().close();
  });
});

test('points are marked without a mouse', async () => {
  await newcomer(async review => {
    const page = await sitDown(browser, review, 'Ada');
    await ready(page);
    await page.getByRole('button', {name: 'Mark two points of the ground'})
        .press('Enter');
    const point = page.locator('[data-mark="ground-0"]');
    await point.focus();
    const before = await point.getAttribute('cy');
    await page.keyboard.press('ArrowUp');
    assert.ok(Math.abs(await point.getAttribute('cy') - before + 0.5) < 1e-9);
    assert.equal(await page.evaluate(
        () => document.activeElement.dataset.mark), 'ground-0');
    await page.getByRole('button', {name: 'remove: Mark two points of the ' +
        'ground'}).press('Enter');
    assert.equal(await page.locator('.mark').count(), 0);
    await page.context().close();
  });
});

const kViews = {wide: [1280, 'light'], dark: [1280, 'dark'],
                phone: [390, 'light']};

for (const [name, [width, colorScheme]] of Object.entries(kViews)) {
  test(`axe-core has nothing to say, and nothing is cut off (${name})`,
       async () => {
    await newcomer(async review => {
      const page = await sitDown(browser, review, 'Ada',
                                 {width, height: 900});
      await page.emulateMedia({colorScheme});
      const look = async at => {
        await page.evaluate(axe);
        const {violations} = await page.evaluate(() => globalThis.axe.run());
        assert.deepEqual(violations.map(
            v => `${v.id}: ${v.nodes.map(n => n.html).join(' | ')}`), []);
        await picture(page, `${at}-${name}`);
        assert.ok(await page.evaluate(
            () => document.documentElement.scrollWidth <= innerWidth));
      };
      await ready(page);
      await page.fill('#setup-name', 'looked at');
      await page.fill('#setup-diameter_mm', '40');
      await page.click('text=Mark two points of known distance');
      await look('setup');
      await page.getByRole('button', {name: /^remove/}).click();
      await page.getByRole('button', {name: 'Analyse'}).click();
      await page.waitForSelector('.answer');
      await look('answer');
      await page.getByRole('button', {name: 'Keep it'}).click();
      await says(page, '.under', 'looked at');
      await page.goto(`${review.origin}/#/recordings`);
      await page.waitForSelector('form[aria-label="Analyse"]');
      await look('recordings');
      await page.context().close();
    });
  });
}

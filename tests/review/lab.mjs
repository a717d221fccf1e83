// A laboratory for the tests of the page: a store with a rendered trial, the
// server as a user starts it, and a browser.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {mkdirSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {createInterface} from 'node:readline';
import {after, before} from 'node:test';

import {chromium} from 'playwright-core';

const binary = process.env.TOUCHDOWN_BINARY;
export const kCampaign = 'sphere on board';

export function touchdown(...args) {
  return execFileSync(binary, args, {encoding: 'utf8'});
}

// A rendered shot of a sphere at 20 degrees, of 130 frames: touchdown between
// frames 89 and 90.
function scene() {
  const shot = JSON.parse(touchdown('simulate', '--example'));
  shot.lead_in_frames = 50;
  shot.frames = 130;
  shot.thrown.start.gap_mm = 8.15;  // down between two frames, not at one
  return shot;
}

// Writes the shot into `folder`, as sphere_20_deg.mraw where no other format is
// asked for; `change` may alter the scene.
export function film(folder, change = () => {}, ...args) {
  const shot = scene();
  change(shot);
  mkdirSync(folder, {recursive: true});
  const file = join(mkdtempSync(join(tmpdir(), 'touchdown-scene-')),
                    'scene.json');
  writeFileSync(file, JSON.stringify(shot));
  touchdown('simulate', file, '--out', folder, ...args);
  rmSync(dirname(file), {recursive: true});
}

// A store with one analysed recording and a campaign.
export class Lab {
  constructor() {
    this.folder = mkdtempSync(join(tmpdir(), 'touchdown-review-'));
    this.db = join(this.folder, 'lab.db');
    this.clips = join(this.folder, 'clips');
    film(this.clips);
    this.clip = join(this.clips, 'sphere_20_deg.mraw');
    this.addCampaign(kCampaign);
    touchdown('analyze', this.clip, '--db', this.db, '--campaign', kCampaign);
    this.trial = this.list()[0].id;
  }

  addCampaign(name) {
    touchdown('campaign', 'new', name, '--db', this.db, '--body', 'sphere',
              '--diameter-mm', '40', '--surface', 'board');
  }

  list() {
    return JSON.parse(touchdown('list', '--db', this.db, '--json')).trials;
  }

  // touchdown.trial/1: the trial as it stands, and its `history`.
  show(id = this.trial) {
    return JSON.parse(touchdown('show', id, '--db', this.db, '--json'));
  }

  remove() { rmSync(this.folder, {recursive: true, force: true}); }
}

// A test that fails before it stops its server must not hold up the others.
const servers = [];
after(() => { for (const server of servers) server.kill('SIGKILL'); });

// The server, as `touchdown review` starts it.
export async function startReview(db, ...args) {
  const child = spawn(binary, ['review', '--db', db, '--no-open', ...args],
                      {stdio: ['ignore', 'pipe', 'ignore']});
  servers.push(child);
  const lines = createInterface({input: child.stdout});
  const address = await new Promise((resolve, reject) => {
    lines.once('line', resolve);
    child.once('exit', status => reject(new Error(`it ended: ${status}`)));
  });
  const url = new URL(address);
  return {
    address,
    origin: url.origin,
    token: url.searchParams.get('token'),
    stop: (signal = 'SIGTERM') => new Promise(resolve => {
      child.removeAllListeners('exit');
      child.once('exit', resolve);
      child.kill(signal);
    }),
  };
}

export function openBrowser() {
  return chromium.launch({
    executablePath: process.env.TOUCHDOWN_CHROMIUM,
    args: ['--no-sandbox', '--disable-dev-shm-usage'],
  });
}

// What the tests of one file share, from their first to their last.
export let lab, review, browser;
export function useLaboratory() {
  before(async () => {
    lab = new Lab();
    review = await startReview(lab.db, '--recordings', lab.clips);
    browser = await openBrowser();
  });
  after(async () => {
    await browser?.close();
    await review?.stop();
    lab?.remove();
  });
}

// A person at a page of their own: cookies and storage of nobody else. Every
// word of the browser's console is kept: there must be none.
export async function sitDown(browser, review, name, size = {width: 1280,
                                                             height: 720}) {
  const context = await browser.newContext({viewport: size});
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  page.complaints = [];
  page.requested = [];
  page.on('console', message => {
    // A refused request is also told in the console.
    if (message.type() === 'error' &&
        !message.text().startsWith('Failed to load resource')) {
      page.complaints.push(message.text());
    }
  });
  page.on('pageerror', error => page.complaints.push(String(error)));
  page.on('request', request => page.requested.push(request.url()));
  await page.goto(review.address);
  // The page that takes the key leads on to the one that is worked on.
  await page.waitForURL(review.origin + '/', {waitUntil: 'load'});
  if (name) {
    await page.fill('#who', name);
    await page.locator('#who').blur();
  }
  return page;
}

// Nothing complained of, nothing asked of any other server.
export function requireClean(page, review) {
  assert.deepEqual(page.complaints, []);
  for (const url of page.requested) {
    assert.ok(url.startsWith(review.origin + '/'), `asked elsewhere: ${url}`);
  }
}

// A picture of the page, for a person to look at (and for the walk-through).
export async function picture(page, name) {
  const folder = process.env.TOUCHDOWN_PICTURES;
  if (!folder) return;
  mkdirSync(folder, {recursive: true});
  // Camera noise makes PNGs large.
  await page.screenshot({path: join(folder, name + '.jpg'), type: 'jpeg',
                         quality: 72});
}

// The frame that is on the screen, once it is `frame`.
export async function frameShown(page, frame) {
  await page.waitForFunction(
      n => document.querySelector('.picture')?.dataset.shown === String(n),
      frame);
}

// Waits until an element says `text`.
export async function says(page, selector, text) {
  await page.locator(selector, {hasText: text}).first().waitFor();
}

// Asks for frames as a person's keys do, and for memory as the kernel counts it.
// Usage: node review.mjs PROGRAM STORE OUT
import {execFileSync, spawn} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import http from 'node:http';
import {availableParallelism, cpus} from 'node:os';
import {join} from 'node:path';
import {createInterface} from 'node:readline';

const [program, db, out] = process.argv.slice(2);
const trials = JSON.parse(execFileSync(
    program, ['list', '--db', db, '--json'], {encoding: 'utf8',
                                              maxBuffer: 1 << 26})).trials;

async function serve() {
  const child = spawn(program, ['review', '--db', db, '--no-open'],
                      {stdio: ['ignore', 'pipe', 'ignore']});
  const address = new URL(await new Promise(
      resolve => createInterface({input: child.stdout}).once('line', resolve)));
  return {child, address};
}

const agent = new http.Agent({keepAlive: true, maxSockets: 6});

// Milliseconds from asking to the last byte.
function frame({address}, trial, n) {
  const start = performance.now();
  return new Promise((resolve, reject) => {
    http.get({host: address.hostname, port: address.port, agent,
              path: `/api/trials/${trial.id}/frames/${n}`,
              headers: {'X-Touchdown-Token': address.searchParams.get('token')}},
             response => {
      response.on('data', () => {});
      response.on('end', () => response.statusCode === 200
          ? resolve(performance.now() - start)
          : reject(new Error(`frame ${n}: ${response.statusCode}`)));
    }).on('error', reject);
  });
}

// A person's way through a clip of 280 frames: along it, back, in tens, to both
// ends, to the contact, and where they like.
function way() {
  const frames = [];
  for (let n = 160; n < 200; ++n) frames.push(n);
  for (let n = 200; n > 160; --n) frames.push(n);
  for (let n = 0; n < 280; n += 10) frames.push(n);
  for (let n = 279; n >= 0; n -= 10) frames.push(n);
  for (let i = 0; i < 10; ++i) frames.push(0, 279, 180);
  let seed = 1;
  for (let i = 0; i < 60; ++i) {
    seed = seed * 48271 % 2147483647;
    frames.push(seed % 280);
  }
  return frames;
}

const at = (sorted, share) =>
    sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];

// Of the process alone: pages of mapped files are the kernel's to take back.
function anonymous_mb(pid) {
  const status = readFileSync(`/proc/${pid}/status`, 'utf8');
  return Number(/RssAnon:\s+(\d+)/.exec(status)[1]) / 1024;
}

// Processor time of the server so far, ms: says more than the clock where other
// work shares the machine. The kernel counts in hundredths of a second.
function processor_ms(pid) {
  const after = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1];
  const fields = after.split(' ');
  return 10 * (Number(fields[11]) + Number(fields[12]));
}

const rows = [];
for (const format of ['mraw', 'mp4']) {
  const server = await serve();
  const own = trials.filter(t => t.clip.path.endsWith(format));
  const times = [];
  const before = processor_ms(server.child.pid);
  for (const n of way()) times.push(await frame(server, own[0], n));
  const spent = processor_ms(server.child.pid) - before;
  const sorted = [...times].sort((a, b) => a - b);
  // Ten pages at ten recordings, each going along its own.
  for (let n = 150; n < 210; ++n) {
    await Promise.all(own.map(trial => frame(server, trial, n)));
  }
  rows.push({format, requests: times.length, first: times[0],
             median: at(sorted, 0.5), p95: at(sorted, 0.95),
             most: sorted[sorted.length - 1],
             processor: spent / times.length,
             memory: anonymous_mb(server.child.pid)});
  server.child.kill('SIGTERM');
}
agent.destroy();

const heading = 'clip,requests,first_ms,median_ms,p95_ms,most_ms,' +
    'processor_ms,ten_recordings_mb,machine,commit,date';
const now = new Date().toISOString().slice(0, 16) + 'Z';
writeFileSync(join(out, 'review.csv'), [heading, ...rows.map(
    r => [r.format, r.requests, r.first.toFixed(1), r.median.toFixed(1),
          r.p95.toFixed(1), r.most.toFixed(1), r.processor.toFixed(1),
        r.memory.toFixed(0),
          `"${process.env.MACHINE ?? cpus()[0].model}"`, process.env.COMMIT,
          now].join(','))].join('\n') + '\n');
const text = [
  '# Benchmark: review', '',
  `${process.env.MACHINE}, ${availableParallelism()} cores; commit ` +
      `${process.env.COMMIT}; ${now}; 1280x800, 280 frames.`, '',
  '| clip | requests | first, ms | median, ms | p95, ms | greatest, ms | ' +
      'processor, ms each | ten recordings, MB |',
  '|---|---:|---:|---:|---:|---:|---:|---:|',
  ...rows.map(r => `| ${r.format} | ${r.requests} | ${r.first.toFixed(1)} | ` +
      `${r.median.toFixed(1)} | ${r.p95.toFixed(1)} | ${r.most.toFixed(1)} | ` +
      `${r.processor.toFixed(1)} | ${r.memory.toFixed(0)} |`)].join('\n') + '\n';
writeFileSync(join(out, 'review.md'), text);
process.stdout.write(text);

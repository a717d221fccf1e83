// The report: built, looked at, downloaded.
import {element, post, tell} from './parts.js';

const kFiles = [
  ['table1.html', 'the page, to read and to print'],
  ['table1.csv', 'one line a trial'],
  ['table1.csv-metadata.json', 'what its columns mean'],
  ['table1.md', 'Markdown'],
  ['table1.tex', 'Table 1 for LaTeX'],
  ['table1.json', 'every number'],
];

export async function report(main) {
  const files = element('div');
  const trouble = element('p', {class: 'bad', role: 'alert'});
  const build = element('button', {class: 'main', text: 'Build the report',
                                   onclick: make});

  async function make() {
    build.disabled = true;
    trouble.textContent = '';
    tell('Building the report …');
    try {
      const made = await post('/api/report', {});
      tell(`The report of ${made.trials} trials is built.`);
      files.replaceChildren(
          element('p', {text: `In ${made.folder}:`}),
          element('ul', {}, ...kFiles.map(([name, what]) => element('li', {},
              name.endsWith('.html')
                  ? element('a', {href: `/report/${name}`, target: '_blank',
                                  rel: 'noopener', text: 'View ' + name})
                  : element('a', {href: `/report/${name}`, download: name,
                                  text: 'Download ' + name}),
              `: ${what}`))),
          element('p', {}, element('a', {href: '/report/table1.html',
                                         download: 'table1.html',
                                         text: 'Download table1.html'})));
    } catch (error) {
      tell('');
      trouble.textContent = error.message;
    }
    build.disabled = false;
  }

  main.replaceChildren(
      element('h1', {text: 'Report'}),
      element('p', {text: 'Every trial of this store against the published ' +
          'boundary angles, like Table 1 of the paper, with its evidence.'}),
      build, trouble, files);
}

// One command makes the pictures of README and docs, a different one of each scene shown.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { acceptance, EVERYTHING, pageFile, programFile, root, say } from './support/acceptance.mjs';
import { Browser } from './support/browser.mjs';
import { compare } from './support/picture.mjs';

const LEAST = 5;        // pictures
const LARGEST = 300e3;  // bytes

/** Of scenes, and in folders of their own those of joints and of bodies. */
async function pictures(folder) {
  const within = async (name) => (await readdir(path.join(folder, name))).map((file) => `${name}/${file}`);
  const all = await Promise.all([readdir(folder), within('joints'), within('bodies')]);
  return all.flat().filter((name) => name.endsWith('.png')).sort();
}

await acceptance(EVERYTHING, async (test) => {
  execFileSync(path.join(root, 'scripts/screenshots.sh'), [test.folder], {
    stdio: 'inherit', env: { ...process.env, RAGTOP_PROGRAM: programFile, RAGTOP_PAGE: pageFile },
  });
  const names = await pictures(test.folder);
  assert.ok(names.length >= LEAST, `there are ${names.length} pictures`);
  // Models of others need not be there.
  const ofOthers = (name) => name.startsWith('bodies/') && !names.includes(name);
  const shown = (await pictures(path.join(root, 'docs/pictures'))).filter((name) => !ofOthers(name));
  assert.deepEqual(shown, names, 'docs/pictures has others');

  const browser = await Browser.start(test);
  const helper = await browser.empty();
  const files = await Promise.all(names.map((name) => readFile(path.join(test.folder, name))));
  for (const [i, name] of names.entries()) {
    assert.ok(files[i].length <= LARGEST, `${name} has ${files[i].length} bytes`);
    // Of the same size, since those of joints are small.
    const alike = names.filter((other) => path.dirname(other) === path.dirname(name));
    const next = alike[(alike.indexOf(name) + 1) % alike.length];
    const { changed, colors } = await compare(helper, files[i], files[names.indexOf(next)]);
    say(`${name}: ${Math.round(files[i].length / 1000)} kB, ${colors} colours`);
    assert.ok(colors > 500, `${name} shows next to nothing`);
    assert.ok(changed > 0.05, `${name} looks like the next one`);
  }

  const docs = (await readdir(path.join(root, 'docs'))).filter((name) => name.endsWith('.md'));
  const pages = ['README.md', ...docs.map((name) => `docs/${name}`)];
  const text = (await Promise.all(pages.map((page) => readFile(path.join(root, page), 'utf8')))).join('\n');
  for (const name of names) assert.ok(text.includes(`pictures/${name})`), `${name} is in no page of the documentation`);
});

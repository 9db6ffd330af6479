// Bundles the page into one file without references to others: build/page/ragtop.html, or the file given. Beside it the
// page of charts, chart.html, and what draws them without a browser, chart_svg.cjs.
import { createHash } from 'node:crypto';
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import esbuild from 'esbuild';

const here = path.dirname(fileURLToPath(import.meta.url));
const target = path.resolve(process.argv[2] ?? path.join(here, '../build/page/ragtop.html'));

async function bundle(entry, options = {}) {
    const { outputFiles } = await esbuild.build({
        entryPoints: [path.join(here, entry)],
        bundle: true,
        minify: true,
        write: false,
        outdir: here,
        target: ['chrome110', 'firefox115', 'safari16.4'],
        legalComments: 'eof',
        logLevel: 'warning',
        ...options,
    });
    return outputFiles[0].text;
}

function hash(text) {
    return `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
}

/** Only what is in this file runs, and it talks to nobody but those in `connections`. */
function securityPolicy(script, style, connections) {
    return [
        "default-src 'none'",
        `script-src ${hash(script)}`,
        `style-src ${hash(style)}`,
        'img-src data: blob:',
        'font-src data:',
        ...connections,
        "base-uri 'none'",
        "form-action 'none'",
    ].join('; ');
}

function replaceOnce(text, pattern, replacement) {
    if (text.split(pattern).length !== 2) throw new Error(`index.html must contain once: ${pattern}`);
    return text.replace(pattern, () => replacement);
}

/** A page in one file: its script and style are put into its HTML. `packages` are those in it, with their licences. */
async function page(folder, entry, packages, connections) {
    const script = (await bundle(path.join(folder, entry), { format: 'iife' })).trim();
    const style = (await bundle(path.join(folder, 'style.css'))).trim();
    const { dependencies } = JSON.parse(await readFile(path.join(here, 'package.json'), 'utf8'));
    const origin = `Ragtop's page, MIT; with ${packages.map(([name, licence]) => `${name} ${dependencies[name]}, ${licence}`).join('; ')}`;
    let html = await readFile(path.join(here, folder, 'index.html'), 'utf8');
    html = replaceOnce(
        html,
        '<meta charset="utf-8">',
        `<meta charset="utf-8">
  <!-- ${origin} -->
  <meta http-equiv="Content-Security-Policy" content="${securityPolicy(script, style, connections)}">`,
    );
    html = replaceOnce(html, '<link rel="stylesheet" href="style.css">', `<style>${style}</style>`);
    return replaceOnce(html, `<script type="module" src="${entry}"></script>`, `<script>${script}</script>`);
}

const LIVE = "connect-src 'self' ws://127.0.0.1:* ws://localhost:* blob: data:";
const html = await page('.', 'src/main.js', [['lil-gui', 'MIT'], ['three', 'MIT'], ['uplot', 'MIT']], [LIVE]);
const chart = await page('chart', 'main.js', [['echarts', 'Apache-2.0']], []);
const picture = await bundle('chart/svg.js', { format: 'cjs', platform: 'node', target: 'node18' });

await mkdir(path.dirname(target), { recursive: true });
const folder = path.dirname(target);
for (const [file, text] of [
    [target, html],
    [path.join(folder, 'chart.html'), chart],
    [path.join(folder, 'chart_svg.cjs'), picture],
]) {
    await writeFile(file, text);
    const [size, zipped] = [Buffer.byteLength(text), gzipSync(text, { level: 9 }).length];
    console.log(`${file}: ${Math.round(size / 1000)} kB, gzipped ${Math.round(zipped / 1000)} kB`);
}

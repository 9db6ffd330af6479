// Bundles the page into one file without references to others: build/page/ragtop.html, or the file given.
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

/** Only what is in this file runs, and it talks to the program that served it alone. */
function securityPolicy(script, style) {
    return [
        "default-src 'none'",
        `script-src ${hash(script)}`,
        `style-src ${hash(style)}`,
        'img-src data: blob:',
        'font-src data:',
        "connect-src 'self' ws://127.0.0.1:* ws://localhost:* blob: data:",
        "base-uri 'none'",
        "form-action 'none'",
    ].join('; ');
}

function replaceOnce(text, pattern, replacement) {
    if (text.split(pattern).length !== 2) throw new Error(`index.html must contain once: ${pattern}`);
    return text.replace(pattern, () => replacement);
}

const script = (await bundle('src/main.js', { format: 'iife' })).trim();
const style = (await bundle('style.css')).trim();
const { dependencies } = JSON.parse(await readFile(path.join(here, 'package.json'), 'utf8'));
const origin = `Ragtop's page, MIT; with ${Object.entries(dependencies)
    .map(([name, version]) => `${name} ${version}`)
    .join(', ')}, all MIT`;

let html = await readFile(path.join(here, 'index.html'), 'utf8');
html = replaceOnce(
    html,
    '<meta charset="utf-8">',
    `<meta charset="utf-8">
  <!-- ${origin} -->
  <meta http-equiv="Content-Security-Policy" content="${securityPolicy(script, style)}">`,
);
html = replaceOnce(html, '<link rel="stylesheet" href="style.css">', `<style>${style}</style>`);
html = replaceOnce(html, '<script type="module" src="src/main.js"></script>', `<script>${script}</script>`);

await mkdir(path.dirname(target), { recursive: true });
await writeFile(target, html);
const size = Buffer.byteLength(html);
console.log(
    `${target}: ${Math.round(size / 1000)} kB, gzipped ${Math.round(gzipSync(html, { level: 9 }).length / 1000)} kB`,
);

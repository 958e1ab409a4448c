// The page that reconstructs, in headless Chromium: node web.test.mjs (by viewer/test/run.sh, with SOAPFILM_PAGE).
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {inOut, launch, open, pixels} from '../../viewer/test/kit.mjs';

const address = pathToFileURL(resolve(process.env.SOAPFILM_PAGE)).href;
const program = process.env.SOAPFILM_PROGRAM;
const run = (...args) => execFileSync(program, [...args, '--quiet'], {stdio: ['ignore', 'ignore', 'inherit']});
let browser;

before(async () => {
  run('scan', 'torus', '-o', inOut('torus'), '--samples', '8000', '--noise', '0.2%');
  browser = await launch();
});
after(() => browser?.close());

test('scans become the mesh of the program, and nothing is asked of the network', async () => {
  const {page, faults} = await open(browser, address);
  await page.setInputFiles('#files', inOut('torus/samples.ply'));
  await page.waitForSelector('#settings:not([hidden])', {timeout: 60000});
  assert.match(await page.innerText('#found'), /8,000 samples/);
  assert.match(await page.innerText('#memory'), /at most 4,096 MiB for a page: voxels down to about 0\.00\d+ fit/);
  await page.selectOption('#up', '-y'); // changes nothing, the samples have normals
  await page.click('#start');
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'mesh', undefined, {timeout: 60000});
  assert.ok(new Set(await pixels(page)).size > 50, 'the picture is blank');
  assert.match(await page.innerText('#report'), /gap to the global optimum/);
  await page.screenshot({path: inOut('web.png')});
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-ply')]);
  await download.saveAs(inOut('web.ply'));
  run('reconstruct', inOut('torus/samples.ply'), '-o', inOut('program.ply'), '--distance', '--gap');
  const body = (name) => readFileSync(inOut(name), 'latin1').replace(/^comment.*\n/gm, '');
  assert.ok(body('web.ply') === body('program.ply'), 'other bytes than the program');
  const [report] = await Promise.all([page.waitForEvent('download'), page.click('#save-report')]);
  await report.saveAs(inOut('web.json'));
  assert.equal(JSON.parse(readFileSync(inOut('web.json'), 'utf8')).parameters.orient.up, '-y');
  assert.deepEqual(faults, []);
});

test('a file that is none is refused in words', async () => {
  const {page, faults} = await open(browser, address);
  await page.setInputFiles('#files', {
    name: 'broken.ply',
    mimeType: 'application/octet-stream',
    buffer: Buffer.from('ply\nno'),
  });
  await page.waitForSelector('#problem:not([hidden])');
  assert.match(await page.innerText('#problem'), /broken\.ply/);
  assert.deepEqual(faults, []);
});

test('a run can be cancelled', async () => {
  const {page} = await open(browser, address);
  await page.setInputFiles('#files', inOut('torus/samples.ply'));
  await page.waitForSelector('#settings:not([hidden])', {timeout: 60000});
  await page.click('#start');
  await page.click('#cancel');
  assert.ok(await page.isVisible('#drop'));
});

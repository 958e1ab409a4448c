// The search of the site finds pages and leads to them, opened from a disk: run.sh PROGRAM VIEWER_BUILD FOLDER
// ../../docs/site/search.test.mjs after `make docs` (`make test-docs`).
import assert from 'node:assert/strict';
import {resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {launch} from '../../viewer/test/kit.mjs';

let browser;
before(async () => (browser = await launch()));
after(() => browser?.close());

for (const start of ['index.html', 'guide/room.html'])
  test(`from ${start} the options are found`, async () => {
    const page = await browser.newPage({viewport: {width: 1280, height: 800}});
    await page.goto(pathToFileURL(resolve('out/site', start)).href);
    await page.click('input.md-search__input');
    await page.keyboard.type('write-levels', {delay: 20});
    const result = page.locator('a.md-search-result__link[href*="reference/options"]').first();
    await result.click();
    await page.waitForFunction(() => location.pathname.endsWith('/out/site/reference/options.html'));
    assert.match(await page.innerText('h1'), /Options of soapfilm reconstruct/);
  });

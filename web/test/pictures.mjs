// The picture of docs/guide/browser.md: run.sh PROGRAM VIEWER_BUILD FOLDER ../../web/test/pictures.mjs, with SOAPFILM_PAGE.
// FOLDER has hole/samples.ply as docs/guide/viewer.md makes it; browser.png goes there.
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {inOut, launch, open} from '../../viewer/test/kit.mjs';

const browser = await launch();
const address = pathToFileURL(resolve(process.env.SOAPFILM_PAGE)).href;
const {page} = await open(browser, address, {viewport: {width: 1600, height: 900}});
await page.setInputFiles('#files', inOut('hole/samples.ply'));
await page.waitForSelector('#settings:not([hidden])', {timeout: 60000});
await page.click('#start');
await page.waitForFunction(() => document.documentElement.dataset.ready === 'mesh', undefined, {timeout: 60000});
await page.selectOption('#color-by', 'value gap');
await page.waitForTimeout(500);
await page.screenshot({path: inOut('browser.png')});
await browser.close();

// Pictures of the page for the documents: run.sh PROGRAM VIEWER_BUILD FOLDER pictures.mjs. FOLDER has hole/samples.ply,
// hole.ply and hole.report.json as docs/guide/viewer.md makes them; viewer.png and viewer-narrow.png go there.
import {inOut, launch, makePage, open, place} from './kit.mjs';

const browser = await launch();

const wide = makePage('viewer-wide', [inOut('hole.ply')], '--unit', 'mm', '--up', 'z', '--title', 'Torus with a hole');
{
  const {page} = await open(browser, wide, {viewport: {width: 1600, height: 900}});
  await page.selectOption('#color-by', 'value distance');
  await page.click('#legend button:has-text("All")');
  await page.keyboard.press('m');
  const center = await page.evaluate(() => window.soapfilm.data.items[0].box);
  for (const share of [0.2, 0.8]) {
    const shift = [share, 0.12, 0.9]; // of the box: on the near upper side
    const point = [0, 1, 2].map((k) => center.lo[k] + shift[k] * (center.hi[k] - center.lo[k]));
    const {x, y} = await place(page, point);
    await page.mouse.click(x, y);
  }
  await page.waitForTimeout(300);
  await page.screenshot({path: inOut('viewer.png')});
}

const both = makePage(
  'viewer-narrow',
  [inOut('hole/samples.ply'), inOut('hole.ply')],
  '--up',
  'z',
  '--title',
  'Samples and mesh',
);
{
  const narrow = {
    viewport: {width: 390, height: 844},
    deviceScaleFactor: 2,
    hasTouch: true,
    isMobile: true,
    colorScheme: 'dark',
  };
  const {page} = await open(browser, both, narrow);
  await page.keyboard.press('z');
  await page.waitForTimeout(600);
  await page.screenshot({path: inOut('viewer-narrow.png')});
}
await browser.close();

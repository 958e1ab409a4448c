// The page of `soapfilm view` does what it promises, in headless Chromium: node view.test.mjs (by run.sh).
import assert from 'node:assert/strict';
import {statSync, writeFileSync} from 'node:fs';
import {after, before, test} from 'node:test';
import {box, difference, inOut, launch, makePage, open, pixels, place, writePly} from './kit.mjs';

const corner = [417233.25, 5301234.5, 512.125]; // as far from zero as maps are
const size = [4, 2, 1];
let browser, one, two;

before(async () => {
  const shape = box(corner, size, 8);
  const mesh = writePly('box.ply', shape.points, shape.triangles, [
    ['distance', 'float', (i) => i / 100],
    ['red', 'uchar', (i) => i % 256],
    ['green', 'uchar', () => 90],
    ['blue', 'uchar', () => 200],
  ]);
  const samples = writePly('samples.ply', shape.points, null, [['intensity', 'float', (i) => i]]);
  writeFileSync(
    inOut('box.report.json'),
    JSON.stringify({
      parameters: {},
      warnings: ['a warning <b>to see</b>'],
      grid: {voxel: 0.0125, size: [10, 20, 30]},
      method: {name: 'tv'},
      certificate: {relative_gap_binary: 0.0043, lambda: 0.02},
      mesh: {closed: true, manifold: true, components: 1, genus: 0},
    }),
  );
  one = makePage('one', [mesh], '--unit', 'm');
  two = makePage('two', [samples, mesh], '--up', 'z');
  browser = await launch();
});
after(() => browser?.close());

/** Opens a page, runs the test, and asks that nothing went wrong and nothing was asked of any server. */
const inPage = (name, address, work, options) =>
  test(name, async () => {
    const {page, faults, context} = await open(browser, address(), options);
    try {
      assert.equal(await page.evaluate(() => document.documentElement.dataset.ready), 'true');
      await work(page);
      assert.deepEqual(faults, []);
    } finally {
      await context.close();
    }
  });

inPage(
  'shows the mesh, its counts and its report',
  () => one,
  async (page) => {
    const shown = await pixels(page);
    assert.ok(new Set(shown).size > 50, 'the picture is blank');
    const text = await page.innerText('body');
    for (const part of [
      '768 triangles',
      '0.43 %',
      'a warning <b>to see</b>',
      '0.0125 m',
      'closed, manifold, 1 component, genus 0',
    ])
      assert.ok(text.includes(part), `the page lacks: ${part}`);
  },
);

inPage(
  'a drag turns the view',
  () => one,
  async (page) => {
    const start = await pixels(page);
    await page.mouse.move(250, 320);
    await page.mouse.down();
    await page.mouse.move(370, 360, {steps: 4});
    await page.mouse.up();
    await page.waitForTimeout(100);
    assert.ok(difference(start, await pixels(page)) > 0.02);
  },
);

inPage(
  'the section cuts, moves, flips and ends',
  () => one,
  async (page) => {
    const start = await pixels(page);
    await page.keyboard.press('x');
    const cut = await pixels(page);
    assert.ok(difference(start, cut) > 0.01);
    assert.equal(Number(await page.inputValue('#section-number')), corner[0] + size[0] / 2);
    await page.fill('#section-number', String(corner[0] + 1));
    await page.keyboard.press('Enter');
    const moved = await pixels(page);
    assert.ok(difference(cut, moved) > 0.01);
    await page.click('#flip');
    assert.ok(difference(moved, await pixels(page)) > 0.01);
    await page.click('#axis button >> nth=0');
    assert.equal(difference(start, await pixels(page)), 0);
  },
);

inPage(
  'colors by every attribute, with a legend in its numbers',
  () => one,
  async (page) => {
    const seen = [];
    for (const key of await page.$$eval('#color-by option', (options) => options.map(({value}) => value))) {
      await page.selectOption('#color-by', key);
      const shown = await pixels(page);
      for (const other of seen) assert.ok(difference(shown, other) > 0.01, `${key} changes nothing`);
      seen.push(shown);
    }
    assert.equal(seen.length, 5); // nothing, own colors, distance, height, normals
    await page.selectOption('#color-by', 'value distance');
    await page.click('#legend button:has-text("All")');
    const ends = await page.$$eval('#legend input', (inputs) => inputs.map(({value}) => Number(value)));
    assert.deepEqual(ends, [0, 3.85]);
    assert.ok((await page.innerText('#legend h3')).includes('m'), 'the unit of a length');
    const before = await pixels(page);
    await page.fill('#legend input >> nth=1', '1');
    await page.keyboard.press('Enter');
    assert.ok(difference(before, await pixels(page)) > 0.01);
    await page.selectOption('#color-by', 'height');
    const heights = await page.$$eval('#legend input', (inputs) => inputs.map(({value}) => Number(value)));
    assert.deepEqual(heights, [corner[1], corner[1] + size[1]]);
  },
);

/** Clicks with the distance tool; returns what the panel says. */
async function measure(page, a, b, modifiers = []) {
  for (const world of [a, b]) {
    const {x, y} = await place(page, world);
    for (const key of modifiers) await page.keyboard.down(key);
    await page.mouse.click(x, y);
    for (const key of modifiers) await page.keyboard.up(key);
  }
  return parseFloat(await page.textContent('#distance'));
}
const at = (x, y, z) => [corner[0] + x, corner[1] + y, corner[2] + z];

inPage(
  'two clicks measure the true distance, in world coordinates',
  () => one,
  async (page) => {
    await page.keyboard.press('h'); // the panel leaves the view narrow, and the tools are over it
    await page.keyboard.press('0');
    await page.keyboard.press('m');
    const onFront = await measure(page, at(0.5, 0.5, 1), at(3.5, 1.5, 1));
    assert.ok(Math.abs(onFront - Math.hypot(3, 1)) < 0.02, `measured ${onFront}`);
    await page.keyboard.press('Escape');
    const corners = await measure(page, at(0.02, 0.02, 1), at(3.98, 1.98, 1), ['Shift']);
    assert.ok(Math.abs(corners - Math.hypot(4, 2)) < 2e-6, `measured ${corners}`);
    const rows = await page.$$eval('.point .numbers', (spans) =>
      spans.map(({textContent}) => textContent.split(/\s+/).map(Number)),
    );
    assert.deepEqual(rows, [at(0, 0, 1), at(4, 2, 1)]);
  },
);

inPage(
  'what the section has cut away cannot be measured',
  () => one,
  async (page) => {
    await page.keyboard.press('1');
    await page.keyboard.press('z');
    await page.keyboard.press('m');
    await measure(page, at(1, 1, 0.5), at(3, 1, 0.5));
    const rows = await page.$$eval('.point .numbers', (spans) =>
      spans.map(({textContent}) => Number(textContent.split(/\s+/)[2])),
    );
    for (const z of rows) assert.ok(z <= corner[2] + 0.5 + 1e-4, `a point at ${z}`);
  },
);

inPage(
  'two items stand side by side, with cameras that are linked, or not',
  () => two,
  async (page) => {
    const positions = () =>
      page.evaluate(() => window.soapfilm.app.views.views.map(({camera}) => camera.position.toArray()));
    const drag = async () => {
      await page.mouse.move(150, 300);
      await page.mouse.down();
      await page.mouse.move(220, 330, {steps: 4});
      await page.mouse.up();
      await page.waitForTimeout(100);
    };
    assert.equal(await page.evaluate(() => window.soapfilm.app.views.two), true);
    const [start] = await positions();
    await drag();
    const [left, right] = await positions();
    assert.ok(Math.hypot(...left.map((v, k) => v - start[k])) > 1e-3);
    assert.ok(Math.hypot(...left.map((v, k) => v - right[k])) < 1e-9, 'the right camera did not follow');
    await page.keyboard.press('l');
    await drag();
    const [own, other] = await positions();
    assert.ok(Math.hypot(...other.map((v, k) => v - right[k])) < 1e-9, 'the right camera moved');
    assert.notDeepEqual(own, left);
    const before = await pixels(page);
    await page.keyboard.press('2');
    assert.ok(difference(before, await pixels(page)) > 0.01);
  },
);

inPage(
  'samples can be measured: they are hit exactly',
  () => two,
  async (page) => {
    await page.keyboard.press('h');
    await page.keyboard.press('0');
    await page.keyboard.press('m');
    const distance = await measure(page, at(1, 0, 1), at(3, 0, 1));
    assert.equal(distance, 2);
  },
);

inPage(
  'the picture can be saved',
  () => one,
  async (page) => {
    const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('p')]);
    assert.equal(download.suggestedFilename(), 'box.ply.png');
    await download.saveAs(inOut('saved.png'));
    assert.ok(statSync(inOut('saved.png')).size > 5000);
  },
);

inPage(
  'keys are explained',
  () => one,
  async (page) => {
    await page.keyboard.press('?');
    assert.ok(await page.isVisible('#help'));
    assert.ok((await page.innerText('#help')).includes('measure a distance'));
    await page.keyboard.press('Escape');
    assert.ok(!(await page.isVisible('#help')));
  },
);

inPage(
  'keys turn, move and zoom, as far as a drag would',
  () => one,
  async (page) => {
    const camera = () =>
      page.evaluate(() => {
        const {camera, controls} = window.soapfilm.app.views.views[0];
        const {target} = controls;
        const [x, y, z] = camera.position.clone().sub(target).toArray();
        return {target: target.toArray(), distance: Math.hypot(x, y, z), around: Math.atan2(x, z), height: y};
      });
    const press = async (key) => {
      await page.keyboard.press(key);
      await page.waitForTimeout(50);
      return camera();
    };
    const start = await camera();
    const turned = await press('ArrowRight');
    assert.ok(Math.abs(start.around - turned.around - Math.PI / 24) < 1e-6, 'right turns it to the right');
    assert.ok(Math.abs(start.around - (await press('ArrowLeft')).around) < 1e-6, 'left turns it back');
    assert.ok((await press('ArrowDown')).height > start.height + 1e-3, 'down turns its upper side to the viewer');
    assert.ok(Math.abs((await press('ArrowUp')).height - start.height) < 1e-6);
    const before = await pixels(page);
    const moved = await press('Shift+ArrowRight');
    assert.ok(Math.hypot(...moved.target.map((v, k) => v - start.target[k])) > 0.01, 'nothing moved');
    assert.ok(Math.abs(moved.around - start.around) < 1e-6 && Math.abs(moved.distance - start.distance) < 1e-6);
    assert.ok(difference(before, await pixels(page)) > 0.01);
    assert.ok(Math.abs((await press('+')).distance / start.distance - 0.9) < 1e-6);
    assert.ok(Math.abs((await press('-')).distance / start.distance - 1) < 1e-6);
    await page.focus('#size, #color-by'); // its arrows are its own
    assert.deepEqual((await press('ArrowDown')).target, moved.target);
    await page.focus('#view0');
    await page.keyboard.press('x');
    const cut = await page.inputValue('#section-at');
    await page.keyboard.press('PageUp');
    assert.ok(Number(await page.inputValue('#section-at')) > Number(cut), 'the section did not move');
  },
);

inPage(
  'the page of keys opens at its top in a small window, and can be closed there',
  () => one,
  async (page) => {
    await page.keyboard.press('?');
    const {top, scroll, tall} = await page.evaluate(() => {
      const help = document.getElementById('help');
      const {top} = help.querySelector('h2').getBoundingClientRect();
      return {top, scroll: help.scrollTop, tall: help.scrollHeight};
    });
    assert.equal(scroll, 0);
    assert.ok(top >= 0 && tall > 400, 'the title is in sight, and more below');
    await page.screenshot({path: inOut('help-small.png')});
    await page.click('#help button');
    assert.ok(!(await page.isVisible('#help')));
  },
  {viewport: {width: 400, height: 400}},
);

test('above a million triangles fewer are drawn while the camera moves, all of them at rest', async () => {
  const shape = box(corner, size, 300);
  assert.ok(shape.triangles.length > 1e6);
  const address = makePage('many', [writePly('many.ply', shape.points, shape.triangles)], '--triangles', '0');
  const {page, faults, context} = await open(browser, address);
  const drawn = () => page.evaluate(() => window.soapfilm.app.views.renderer.info.render.triangles);
  assert.equal(await page.evaluate(() => window.soapfilm.app.coarse), true);
  const rest = () => page.waitForFunction(() => !window.soapfilm.app.views.moving);
  await rest();
  const full = await pixels(page);
  assert.equal(await drawn(), shape.triangles.length);
  await page.mouse.move(300, 320);
  await page.mouse.down();
  await page.mouse.move(330, 330, {steps: 2});
  await page.waitForFunction(() => window.soapfilm.app.views.moving);
  await page.waitForTimeout(300);
  const few = await drawn();
  assert.ok(few > 1e5 && few < 5e5, `${few} triangles while it moves`);
  await page.screenshot({path: inOut('coarse.png')});
  await page.mouse.move(300, 320);
  await page.mouse.up();
  await rest();
  await page.waitForTimeout(300);
  assert.equal(await drawn(), shape.triangles.length);
  await page.screenshot({path: inOut('full.png')});
  assert.ok(difference(full, await pixels(page)) < 0.001);
  assert.deepEqual(faults, []);
  await context.close();
});

inPage(
  'a small window leaves the views free: neither tools nor legend lie over them',
  () => two,
  async (page) => {
    const box = (name) => page.locator(name).boundingBox();
    for (const panel of [false, true]) {
      if (panel) await page.click('#tool-panel');
      for (const color of ['plain', 'value distance']) {
        await page.evaluate((key) => {
          const {app} = window.soapfilm;
          app.setColoring(app.colorings.find((one) => one.key === key));
        }, color);
        await page.waitForTimeout(400);
        const [upper, lower] = [await box('#view0'), await box('#view1')];
        assert.ok(upper.height > 100 && Math.abs(lower.height - upper.height) < 2, `${upper.height}, ${lower.height}`);
        for (const over of ['#tools', '#legend', '#panel']) {
          if (!(await page.isVisible(over))) continue;
          const {y} = await box(over);
          assert.ok(lower.y + lower.height <= y + 1, `${over} lies over the view, ${color}, panel ${panel}`);
        }
      }
      assert.ok(new Set(await pixels(page)).size > 20, 'the picture is blank');
    }
  },
  {viewport: {width: 400, height: 600}},
);

inPage(
  'a narrow window shows the picture, and the panel on request',
  () => two,
  async (page) => {
    assert.ok(!(await page.isVisible('#panel')));
    assert.ok(new Set(await pixels(page)).size > 20, 'the picture is blank');
    await page.click('#tool-panel');
    await page.waitForTimeout(400);
    assert.ok(await page.isVisible('#panel'));
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 390, `the page is ${wide} pixels wide`);
  },
  {viewport: {width: 390, height: 844}, hasTouch: true, colorScheme: 'dark'},
);

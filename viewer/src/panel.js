// The panel: which items are shown where, and the facts about the page.
import {byId, element} from './dom.js';
import {showIn} from './items.js';
import {swatch} from './legend.js';
import {grouped, short} from './numbers.js';

/** "34,817 triangles", and of how many they are. */
function size(item, unit) {
  const {source} = item;
  if (!item.indices) {
    const shown = grouped(item.samples);
    return source.samples > item.samples ? `${shown} of ${grouped(source.samples)} samples` : `${shown} samples`;
  }
  if (source.triangles === item.triangles) return `${grouped(item.triangles)} triangles`;
  const error = item.error > 0 ? `, moved by about ${short(item.error, 2)}${unit ? ` ${unit}` : ''} at most` : '';
  return `simplified: ${grouped(item.triangles)} of ${grouped(source.triangles)} triangles${error}`;
}

/** The list of items, with a box for each view that is shown. */
export function listItems(data, views) {
  const rows = data.items.map((item) => {
    const boxes = (views.two ? [0, 1] : [0]).map((view) => {
      const name = views.two ? ['left', 'right'][view] : 'shown';
      const box = element('input', {
        type: 'checkbox',
        checked: item.views[view],
        title: name,
        'aria-label': `${item.name}: ${name}`,
      });
      box.onchange = () => {
        showIn(
          item,
          item.views.map((on, k) => (k === view || (!views.two && k === 1) ? box.checked : on)),
        );
        captions(data, views);
        views.draw();
      };
      return box;
    });
    return element(
      'li',
      {},
      swatch(`rgb(${item.base.join(' ')})`),
      element('span', {class: 'grow'}, element('b', {}, item.name), element('small', {}, size(item, data.unit))),
      ...boxes,
    );
  });
  byId('items').replaceChildren(...rows);
}

/** Under each of two views: what it shows. */
export function captions(data, views) {
  for (const [index, {caption}] of views.views.entries()) {
    caption.textContent = data.items
      .filter((item) => item.views[index])
      .map((item) => item.name)
      .join(' + ');
    caption.hidden = !views.two;
  }
}

export function head(data) {
  byId('title').textContent = data.title;
  const triangles = data.items.reduce((sum, item) => sum + (item.source.triangles ?? 0), 0);
  const samples = data.items.reduce((sum, item) => sum + (item.source.samples ?? 0), 0);
  const parts = [];
  if (triangles) parts.push(`${grouped(triangles)} triangles`);
  if (samples) parts.push(`${grouped(samples)} samples`);
  byId('subtitle').textContent = parts.join(' · ');
  const reduced = data.items.some(
    (item) => (item.source.triangles ?? 0) > (item.triangles ?? 0) || (item.source.samples ?? 0) > (item.samples ?? 0),
  );
  const lines = ['This page is one file. It asks no server for anything.'];
  if (reduced) lines.unshift('Items are simplified or thinned for this page; counts and reports are of the files.');
  byId('facts').replaceChildren(
    ...lines.map((line) => element('p', {}, line)),
    element('p', {}, `soapfilm ${data.version}`),
  );
}

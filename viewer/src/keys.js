// The keyboard, and the page that explains it.
import {byId, element} from './dom.js';

const mouse = [
  ['Drag', 'turn'],
  ['Right drag, or Shift and drag', 'move'],
  ['Wheel, or two fingers', 'zoom'],
  ['Double click', 'turn about this point'],
];

let actions = new Map();

function press(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || byId('help').open) return;
  if (event.target.matches?.('input:not([type=checkbox]):not([type=range]), select, textarea')) return;
  const arrow = event.key.startsWith('Arrow');
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const action = actions.get(arrow && event.shiftKey ? `Shift+${name}` : name);
  if (!action) return;
  if (event.target.matches?.('input[type=range]') && (arrow || event.key.startsWith('Page'))) return;
  if (action() !== false) event.preventDefault();
}
addEventListener('keydown', press);

/**
 * `commands`: [key, text, action, name of the key for people]; without a text they are not explained. Keys with Ctrl,
 * Alt or Meta stay the browser's, and those whose action returns false.
 */
export function listen(commands) {
  actions = new Map(commands.map(([key, , action]) => [key, action]));
  const row = ([keys, text]) => element('tr', {}, element('th', {}, ...[keys].flat()), element('td', {}, text));
  const key = (name) => element('kbd', {}, name);
  const rows = commands
    .filter(([, text]) => text)
    .map(([name, text, , shown]) => row([key(shown ?? name.toUpperCase()), text]));
  byId('keys').replaceChildren(element('table', {}, element('tbody', {}, ...mouse.map(row), ...rows)));
}

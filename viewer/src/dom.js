// Small helpers for elements of the page.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children; texts become text, never markup. */
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === 'class') made.className = value;
    else if (name.startsWith('aria-') || name === 'role') made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/**
 * Buttons of which one is pressed. `options` are [value, text, title]; `choose(value)` is called on a press.
 * Returns a function that shows another value as chosen.
 */
export function choice(parent, options, value, choose) {
  const buttons = options.map(([key, text, title]) => {
    const button = element('button', {type: 'button', title: title ?? ''}, text);
    button.onclick = () => choose(key);
    return [key, button];
  });
  parent.replaceChildren(...buttons.map(([, button]) => button));
  const show = (chosen) => {
    for (const [key, button] of buttons) button.setAttribute('aria-pressed', key === chosen);
  };
  show(value);
  return show;
}

/** Lets the browser draw and react before the work goes on. */
export const breathe = () =>
  new Promise((resolve) => {
    const channel = new MessageChannel();
    channel.port1.onmessage = resolve;
    channel.port2.postMessage(0);
  });

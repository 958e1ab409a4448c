// The picture as a file: what is drawn, with measured distance, captions and legend.
import {byId, element} from './dom.js';
import {gradientStops} from './color.js';

const style = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();

function drawMarks(pen) {
  pen.lineWidth = 2;
  for (const mark of byId('marks').children) {
    const at = (name) => Number(mark.getAttribute(name));
    pen.strokeStyle = pen.fillStyle = style('--mark');
    pen.beginPath();
    if (mark.tagName === 'line' && !mark.classList.contains('halo')) {
      pen.moveTo(at('x1'), at('y1'));
      pen.lineTo(at('x2'), at('y2'));
      pen.stroke();
    } else if (mark.tagName === 'circle') {
      pen.arc(at('cx'), at('cy'), at('r'), 0, 7);
      pen.fill();
    } else if (mark.tagName === 'text') {
      const centered = !mark.classList.contains('name');
      text(pen, mark.textContent, at('x'), at('y'), 14, centered ? 'center' : 'left', true);
    }
  }
}

function text(pen, words, x, y, size, align, halo) {
  pen.font = `${size}px ${style('--font')}`;
  pen.textAlign = align;
  pen.lineJoin = 'round';
  if (halo) {
    pen.strokeStyle = style('--ground');
    pen.lineWidth = 4;
    pen.strokeText(words, x, y);
    pen.lineWidth = 2;
  }
  pen.fillStyle = style('--ink');
  pen.fillText(words, x, y);
}

function drawLegend(pen, box, top) {
  const legend = byId('legend');
  const bar = legend.querySelector('.bar');
  if (legend.hidden || !bar) return;
  const place = (element) => element.getBoundingClientRect();
  const at = place(bar);
  const fill = pen.createLinearGradient(at.left - box.left, 0, at.right - box.left, 0);
  for (const [share, color] of gradientStops(bar.dataset.map)) fill.addColorStop(share, color);
  pen.fillStyle = fill;
  pen.fillRect(at.left - box.left, at.top - top, at.width, at.height);
  const title = place(legend.querySelector('h3'));
  text(pen, legend.querySelector('h3').textContent, title.left - box.left, title.bottom - top - 3, 13, 'left', true);
  for (const tick of legend.querySelectorAll('.ticks span')) {
    const mark = place(tick);
    text(pen, tick.textContent, mark.left + mark.width / 2 - box.left, mark.bottom - top - 3, 12, 'center', true);
  }
}

/** Draws everything into a canvas of its own. */
export function picture(views) {
  views.rest();
  views.drawNow(); // a canvas of WebGL keeps its pixels only until the browser shows it
  const source = views.renderer.domElement;
  const canvas = element('canvas', {width: source.width, height: source.height});
  const pen = canvas.getContext('2d');
  pen.fillStyle = style('--ground');
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(source, 0, 0);
  const box = byId('stage').getBoundingClientRect();
  pen.scale(canvas.width / box.width, canvas.height / box.height);
  drawMarks(pen);
  for (const view of views.shown()) {
    if (view.caption.textContent && !view.caption.hidden) {
      const at = view.caption.getBoundingClientRect();
      text(
        pen,
        view.caption.textContent,
        at.left + at.width / 2 - box.left,
        at.bottom - box.top - 6,
        13,
        'center',
        true,
      );
    }
  }
  drawLegend(pen, box, box.top);
  return canvas;
}

/** Saves the picture as NAME.png. */
export function savePicture(views, name) {
  picture(views).toBlob((blob) => {
    const link = element('a', {href: URL.createObjectURL(blob), download: `${name}.png`});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }, 'image/png');
}

// What the npm package exports: web/package.mjs puts what Emscripten made, createSoapfilm, before it.
/* global createSoapfilm */
import {engine as around} from './engine.js';

/** An engine of its own for each call: engine.js says what it does. */
export const engine = (onEvent = () => {}) => around(createSoapfilm, onEvent);

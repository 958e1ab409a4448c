// node serve.mjs FOLDER PORT: serves the files of a folder to this machine alone. Port 0: any that is free.
import {createReadStream, statSync} from 'node:fs';
import {createServer} from 'node:http';
import {extname, join, normalize, resolve} from 'node:path';

const [folder, port] = [resolve(process.argv[2]), Number(process.argv[3] ?? 8000)];
// Browsers run a module only if it comes as JavaScript.
const types = {'.html': 'text/html; charset=utf-8', '.mjs': 'text/javascript', '.cjs': 'text/javascript'};

const server = createServer((request, response) => {
  const name = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
  const path = join(folder, name.endsWith('/') ? `${name}index.html` : name);
  if (!path.startsWith(folder) || !statSync(path, {throwIfNoEntry: false})?.isFile()) {
    response.writeHead(404).end('not found\n');
    return;
  }
  response.writeHead(200, {'content-type': types[extname(path)] ?? 'application/octet-stream'});
  createReadStream(path).pipe(response);
});
server.listen(port, '127.0.0.1', () => console.log(`http://localhost:${server.address().port}/ (Ctrl-C ends it)`));

// Unpacks the program and the data, and starts the program.
(() => {
  const message = document.getElementById('message');
  const fail = (error) => {
    message.hidden = false;
    message.textContent = `This page cannot be shown: ${error.message ?? error}`;
    document.documentElement.dataset.state = 'failed';
    console.error(error);
  };
  const unpack = (id) => {
    const text = atob(document.getElementById(id).textContent);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = text.charCodeAt(i);
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  };
  const run = async () => {
    const [program, data] = await Promise.all([unpack('program'), unpack('data')]);
    globalThis.replay = (create) => create(data).then(() => (message.hidden = true), fail);
    const script = document.createElement('script');
    script.textContent = new TextDecoder().decode(program);
    document.body.append(script);
  };
  run().catch(fail);
})();

// A worker of the page: one module, asked by messages. The first message brings the module, every other a request.
let engine;
addEventListener("message", async ({ data }) => {
  const { id, module, request, body } = data;
  try {
    if (module) {
      engine = await Engine.start(module, (states) => postMessage({ judged: states }));
      postMessage({ id, told: {} });
      return;
    }
    const { told, bytes } = engine.ask(request, body);
    postMessage({ id, told, bytes, memory: engine.memory }, [bytes.buffer]);
  } catch (error) {
    postMessage({ id, error: error.message, ended: error instanceof Ended });
  }
});

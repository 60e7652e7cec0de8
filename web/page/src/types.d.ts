// Texts that the bundler puts into the page.
declare module "repository:*" {
  const text: string;
  export default text;
}
declare module "worker:text" {
  const text: string;
  export default text;
}

//! stub
pub(crate) fn check(_: &[u8]) -> Result<(), String> {
    Err("not validated yet".into())
}
pub(crate) fn length(bytes: &[u8]) -> Result<usize, String> {
    Ok(bytes.len())
}

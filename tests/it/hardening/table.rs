//! The table of attacks: what each one does, and the tests that show that the service withstands it.
//!
//! A row is a line with the name of the attack and what is sent or what fails, then a line for each test function.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Attacks that were measured against a running service. Most of their tests have the letter of the row in their names.
const MEASURED: &str = "\
C1: Small estimates of words with a dual average on open meshes, at levels where the counting itself is the load.
- c1_counts_after_each_d_are_as_built
- c1_estimates_count_and_do_not_build
- c1_what_cannot_be_counted_within_the_bound_is_refused_without_being_made
- c1_a_forecast_that_nobody_waits_for_stops
- c1_a_refusal_names_the_level_the_bytes_the_bound_and_the_remedy
C2: Hundreds of glTF files of some hundred bytes that announce a million vertices, each kept as a job for later.
- c2_numbers_without_bytes_are_refused
- c2_what_is_used_again_is_bounded_by_the_weight
- c2_a_record_holds_the_request_and_not_the_input
- c2_records_leave_for_others_and_jobs_under_way_do_not
C3: Many long bodies at once whose parsed form is far larger than their text.
- c3_documents_are_counted_before_anything_is_made_of_them
- c3_gltf_takes_no_more_than_its_weight
- c3_no_request_takes_more_than_its_weight
- c3_requests_are_read_few_at_once_while_health_goes_on
- c3_a_client_that_leaves_while_it_waits_to_be_read_leaves_the_line
H1: All connections drip bytes, hold bodies that are nearly complete, or join one slow computation.
- h1_bodies_take_from_the_account_as_they_arrive_and_one_peer_gets_half
- h1_requests_that_join_a_computation_count_as_those_that_wait
- h1_a_quarter_of_the_connections_never_waits_for_computations
- h1_a_peer_with_all_its_connections_loses_its_own_and_not_those_of_others
- a_body_that_arrives_more_slowly_than_at_the_least_rate_is_answered_408
H2: One client queues hundreds of small jobs for later, and others wait behind them.
- h2_many_jobs_of_one_client_leave_room_for_others
- h2_peers_take_turns_however_many_jobs_one_has
- h2_a_job_that_is_deleted_is_cancelled_and_forgotten
- h2_deleting_a_job_ends_one_interest_and_not_that_of_others
H3: Pictures of stacked faces or of faces with very many corners, and limits at high valence, that look quick.
- h3_a_picture_of_stacked_quads_is_told_by_what_they_cover
- h3_a_picture_of_one_face_with_many_corners_is_told_by_its_triangles
- h3_limits_around_a_vertex_of_many_faces_take_as_long_as_there_are_faces
- h3_limits_that_look_at_whole_fans_are_told_by_the_square_of_the_faces
- h3_work_that_takes_longer_than_a_second_moves_to_the_long_lane
H4: A disk that takes seconds for a sync, or never ends one.
- h4_a_disk_that_hangs_holds_two_threads_and_a_bounded_number_of_artifacts
- h4_what_waits_for_the_disk_holds_no_more_memory_than_an_eighth_of_the_cache
- h4_results_of_any_size_are_answered_though_no_sync_ends
- h4_reads_of_a_disk_that_hangs_hold_four_threads_and_count_as_misses
- h4_the_service_ends_though_the_disk_hangs
H5: A tolerance whose level takes minutes to be searched for, asked for again and again by clients that leave.
- h5_a_search_counts_its_work_and_stays_within_what_it_says
- h5_a_search_stops_when_it_is_told_to
- h5_a_search_is_refused_without_one_where_that_can_be_told_at_once
- h5_searches_with_one_answer_have_one_key
- h5_the_search_of_a_client_that_leaves_is_stopped_and_refusals_are_remembered
M1: Many clients that read their large answers slowly.
- m1_answers_that_are_not_read_hold_no_more_than_their_share
- m1_results_that_no_store_takes_are_paid_for_until_they_are_read
M2: A long job that waits for memory stands before short ones.
- m2_a_long_job_that_waits_for_memory_does_not_hold_short_ones_up
M3: Jobs that take more memory than their forecast says.
- m3_words_with_and_without_duals_hold_what_they_say
- m3_schemes_hold_what_they_say
- m3_formats_hold_what_they_say
- m3_limits_hold_what_they_say
- m3_what_is_refined_along_holds_what_it_says
M4: Short bodies that take long to be checked, read where all connections are served.
- m4_short_bodies_are_read_and_checked_off_the_event_loop_like_long_ones
M5: Caches that are off or fail, so that a result might be computed once more for its own answer.
- m5_a_result_is_computed_once_whatever_the_caches_take
- m5_a_result_is_computed_once_though_the_disk_fails_within_it
- m5_only_what_the_disk_has_lost_is_computed_again
M6: A disk that is full while the store believes that it has room.
- m6_a_full_disk_evicts_the_least_recently_used_until_the_new_artifact_fits
- m6_a_full_disk_with_nothing_left_to_evict_refuses_and_works_again_with_room
- m6_a_disk_that_finds_itself_full_at_a_sync_evicts_and_writes_again
- m6_a_full_disk_is_told_until_a_write_succeeds
- m6_large_results_evict_from_a_full_disk_while_they_are_made
M7: A result that is used from memory alone becomes the oldest one on disk.
- m7_uses_in_memory_keep_an_artifact_on_disk
M8: A value of the wrong kind where a choice, an option or a parameter stands.
- m8_a_value_of_any_kind_in_any_field_of_a_job_is_taken_by_its_schema_or_told_by_its_place
- m8_and_in_any_field_of_a_question
- m8_a_choice_is_written_as_a_text_and_told_with_what_it_may_be
- m8_options_and_parameters_of_any_kind_are_taken_or_told_by_their_place
M9: A standard error stream that nobody reads.
- m9_a_log_that_nobody_reads_holds_no_request_and_no_end
- m9_dropped_lines_are_counted_and_told_when_the_log_is_read_again
M10: A page of any site that has the browser of its reader post jobs to the reader's own machine.
- m10_on_a_loopback_address_pages_of_the_same_machine_may_ask_and_no_others
- m10_on_other_addresses_no_page_may_ask_unless_it_is_said
- m10_the_setting_names_origins_all_or_none
- m10_refusals_of_the_guard_can_be_read_by_pages_that_may_ask
- m10_origins_are_read_strictly_and_as_browsers_write_them
L long texts: Keys, values, headers and addresses of megabytes that answers and the log repeat.
- l_a_long_key_or_value_anywhere_is_shortened_in_the_answer
- l_an_answer_is_bounded_however_many_faults_there_are
- l_headers_and_addresses_are_shortened_in_the_answer
- l_a_line_of_the_log_is_short_however_long_the_request_was
L hosts: Hosts that only begin like those of the own machine, two hosts, or none.
- l_what_is_no_host_with_or_without_a_port_is_refused
- l_a_request_has_one_host
- l_an_absolute_address_is_checked_like_the_header
L slow readers: Honest clients on slow lines that are cut like hostile ones.
- l_a_reader_at_twenty_kilobytes_a_second_is_never_cut_and_one_that_stops_is
- a_client_that_does_not_read_its_answer_is_let_go
L refusals of the HTTP library: Requests that it refuses by itself, and transfer codings that it lets pass.
- refusals_of_the_http_library_are_problems_too
- l_a_transfer_coding_other_than_chunked_is_refused_and_not_read_as_json
L settings: Settings beyond all bounds, and a settings file without an end.
- l_every_number_has_a_range_that_holds_its_default_and_nothing_outside_it_is_taken
- l_a_number_out_of_range_is_told_with_setting_value_bound_and_remedy
- l_a_settings_file_is_a_regular_file_of_at_most_a_mebibyte
L folder of the store: A folder where an artifact should stand, and a lock file that was removed.
- l_a_folder_in_place_of_an_artifact_stops_neither_the_start_nor_other_artifacts
- l_a_folder_that_takes_the_place_of_an_artifact_costs_one_write
- l_a_result_whose_place_on_disk_is_occupied_is_answered_and_counted
- l_removing_the_lock_file_lets_no_second_store_in
L late bit flip: A bit that flips on disk in a part of an artifact that is read after its answer has begun.
- l_a_bit_flipped_behind_the_first_part_cuts_one_answer_and_drops_the_artifact
L ranges: Units of ranges in capital letters, and positions with signs.
- l_units_know_no_small_and_large_letters_and_positions_are_digits_alone
- l_weights_and_waits_are_digits_alone_too
";

/// Attacks and faults that the service was designed against from the beginning.
const DESIGNED: &str = "\
level bomb: A few letters that ask for more vertices than there is memory on earth.
- a_level_bomb_is_counted_and_refused
- counts_of_meshes_are_as_forecast
- forecasts_of_absurd_counts_saturate
- a_result_that_would_be_too_large_names_the_level_that_is_not
- levels_are_whole_and_bounded
grid bomb: A small batch that asks for more jobs than anybody can do, or copies a large mesh into each of them.
- a_grid_is_counted_before_any_of_its_jobs_is_made
- a_fault_points_to_the_job_or_to_the_axis_and_nothing_is_begun
NaN and infinity: Numbers that are not finite, or grow beyond all bounds while they are refined.
- numbers_that_are_not_finite_are_refused
- numbers_beyond_f64_are_faults_of_their_place
- coordinates_that_grow_beyond_all_bounds_are_refused_naming_the_level
- strange_shapes_and_cameras_give_a_picture
huge JSON: Bodies that are too long, nested too deeply, or hold lists of many wrong items.
- a_mebibyte_of_brackets_is_refused
- deep_nesting_is_refused_wherever_it_stands
- a_body_that_is_too_long_is_413_announced_or_not
- long_lists_are_refused_in_words_not_in_kind
- c3_no_request_takes_more_than_its_weight
compressed bodies: A short compressed body that would unpack into a very long one.
- a_bomb_is_inflated_no_further_than_a_body_may_be_long
- a_frame_that_asks_for_a_large_window_is_refused
- addresses_are_bounded_as_they_come_and_inflated
- a_body_of_another_kind_is_415
slow clients: Half a header, silence, a body that stalls, an answer that is not read, and many idle connections.
- half_a_header_is_not_waited_for
- a_header_that_drips_is_not_waited_for
- a_silent_client_is_let_go
- a_body_that_stalls_is_answered_408
- many_idle_connections_do_not_keep_others_from_their_answers
lying file headers: Mesh files that announce more than they hold, or lead to what is not there.
- huge_counts_allocate_nothing
- changed_numbers_are_read_or_refused
- cut_files_are_read_or_refused
- what_leads_nowhere_is_named
- instances_are_bounded_by_the_bytes_that_are_there
non-manifold meshes: Faces that share an edge with two others, run against a neighbour, or name missing vertices.
- an_edge_has_at_most_two_faces
- neighbours_run_along_their_edge_in_opposite_directions
- huge_indices_are_out_of_range
- fans_that_share_a_vertex_are_parted_and_told
- face_soups_are_refined_or_refused
expression bombs: Expressions that are long, deep, unknown, or have no finite value.
- expressions_are_bounded
- other_texts_are_refused_at_their_place
- values_that_are_not_finite_are_refused
- random_text_is_read_or_refused
path tricks: Addresses that climb, hold a zero byte, or differ in their notation alone.
- no_trick_with_an_address_leads_anywhere
- addresses_that_climb_are_not_resolved
names in archives: Outputs whose names climb, are devices, or differ in large and small letters alone.
- names_of_files_are_safe_and_unique
cache poisoning: Bytes that change on disk, or come from a version with other results.
- a_flipped_bit_is_never_served
- a_flipped_bit_is_recomputed_and_never_served
- a_truncated_or_missing_file_is_noticed_when_read
- artifacts_of_another_results_version_are_removed
- a_lie_under_a_good_checksum_never_panics
hash ambiguity: Two jobs whose encodings are the same bytes.
- different_items_have_different_encodings
- what_was_encoded_can_be_decoded
- jobs_with_different_points_have_different_keys
- meshes_that_differ_have_keys_that_differ
SVG as a script: An artifact or a refusal that a browser might run as a page of the service.
- the_content_location_gives_the_same_bytes_for_ever
- a_page_that_may_ask_may_read_the_headers_of_answers
- what_an_address_says_is_shortened_and_escaped_where_it_is_repeated
- texts_stay_in_their_elements
disk full: A write that fails for want of room.
- a_full_disk_fails_one_commit_and_nothing_else
- a_stopped_watch_and_a_full_disk_end_every_writer
- m6_a_full_disk_evicts_the_least_recently_used_until_the_new_artifact_fits
- m6_a_full_disk_is_told_until_a_write_succeeds
kill -9: The end of the process at any moment of a write.
- whatever_moment_it_is_killed_a_named_artifact_stays_and_none_is_wrong
- opening_removes_left_overs_and_nothing_else
- an_index_that_is_gone_or_garbage_is_made_anew
- whatever_moment_it_is_killed_no_accepted_job_is_lost_and_no_byte_is_wrong
- an_accepted_batch_is_finished_by_the_next_process_and_what_is_done_is_not_done_again
poison: A job that ends the process whenever it is begun.
- a_job_with_which_the_process_ends_six_times_is_given_up
clock jump: A wall clock that is set forward or back by years while jobs wait, or between two processes.
- a_wall_clock_that_jumps_ends_no_job_and_keeps_none_for_ever
- the_machines_clock_counts_on_from_the_wall_clock
- what_waits_or_runs_for_too_long_fails_and_what_is_old_is_forgotten_by_the_clock
- silence_is_broken_every_fifteen_seconds_of_the_clock
overload: More work than there is room for.
- a_full_queue_is_answered_503_while_cached_answers_and_health_go_on
- health_is_answered_while_nothing_is_computed
- short_work_does_not_wait_behind_long_work
- a_job_that_is_too_large_is_refused_before_it_takes_a_place
- readiness_names_the_share_that_is_full
- one_client_has_so_many_batches_and_is_told_when_to_come_back
client gone: Clients that leave while their jobs wait or run.
- the_job_of_a_client_that_leaves_is_stopped
- a_client_that_leaves_gives_its_place_in_line_back
- a_job_goes_on_as_long_as_one_client_stays
- an_archive_is_the_same_to_the_byte_and_what_left_the_cache_is_made_again
- long_work_ends_with_the_last_interest
panic: A computation or the reading of a request fails in a way that nobody foresaw.
- a_computation_that_panics_fails_alone_and_gives_back_what_it_held
stack overflow and want of memory: A request that nests very deeply, or a job that needs too much memory.
- deep_nesting_ends_without_a_stack_overflow
- a_job_that_is_too_large_is_refused_before_it_takes_a_place
- the_shares_of_the_account_come_to_no_more_than_the_whole
- a_share_gives_only_what_it_has_and_serves_those_who_wait_in_their_order
noisy neighbour: One client that keeps the service busy while others ask for little.
- h2_many_jobs_of_one_client_leave_room_for_others
- h2_peers_take_turns_however_many_jobs_one_has
- h1_a_peer_with_all_its_connections_loses_its_own_and_not_those_of_others
- short_work_does_not_wait_behind_long_work
- requests_for_work_beyond_the_minute_are_told_when_to_come_back_and_the_rest_goes_on
- no_more_requests_of_a_client_are_answered_at_once_than_it_may_have
- the_table_of_clients_is_bounded_and_those_who_sent_most_stay
- a_computation_goes_on_for_the_tenant_that_stays_in_every_order_of_leaving
key and signature timing: Keys and signatures that are guessed byte by byte, or read from a stolen file.
- who_shows_no_key_or_a_wrong_one_is_told_what_to_do_and_health_and_catalogue_stay_open
- keys_are_made_listed_and_revoked_and_only_their_hashes_are_kept
- a_role_allows_what_it_says_and_no_more
- on_an_address_of_the_network_the_service_wants_keys_or_to_be_told_that_it_needs_none
- a_body_is_not_read_for_who_is_not_let_in
signed URL replay: Signed addresses that are used after their time, altered, or put together from others.
- what_is_altered_expired_or_signed_by_another_is_refused_and_told_apart
- an_address_that_is_too_long_or_inflates_to_too_much_is_refused_before_it_is_read
- a_signed_address_shows_a_render_without_a_key_and_only_that
other tenants: Names, tags and times by which one tenant would learn of what another has made or sent.
- a_result_of_one_tenant_is_made_again_for_another_and_found_by_neither_name_nor_tag
- who_may_see_a_result_is_still_known_after_a_restart
- jobs_of_one_tenant_are_unknown_to_another_whatever_is_done_to_them
- an_upload_opens_nothing_for_a_tenant_that_has_not_sent_it
- variants_searches_and_analyses_are_made_for_each_tenant
- who_leaves_before_the_end_has_nothing_of_what_was_made_for_another
log and label injection: Methods, addresses and traces that would make labels, or lines of the log.
- no_client_makes_a_label
- a_trace_is_read_as_the_recommendation_has_it
- a_trace_goes_on_in_the_answer_and_names_the_refusal
determinism drift: Results that depend on the number of threads or on the build.
- results_have_the_committed_hashes_with_1_2_and_8_threads
- bytes_do_not_depend_on_the_number_of_threads
- the_number_of_threads_does_not_change_a_byte
- any_number_of_threads_finds_the_same_limits
supply chain: A crate from elsewhere, or under a licence that does not go with ours.
- crates_come_from_the_registry_under_licences_that_are_allowed
- expressions_of_licences_are_met_by_one_alternative_or_by_none
";

/// Adds the names of all test functions in the files below a folder.
fn collect(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.extend(names(&fs::read_to_string(path).unwrap()));
        }
    }
}

/// Returns the names of the functions that follow a line with the attribute of a test; other attributes and comments
/// may be between. Functions in the macro of proptest have this attribute, too.
fn names(text: &str) -> Vec<String> {
    let (mut names, mut is_test) = (Vec::new(), false);
    for line in text.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("fn ").filter(|_| is_test) {
            names.extend(rest.split_once('(').map(|(name, _)| name.to_owned()));
        }
        is_test = line == "#[test]" || (is_test && (line.starts_with("#[") || line.starts_with("//")));
    }
    names
}

/// An attack with the tests that show the defence.
struct Row {
    name: &'static str,
    tests: Vec<&'static str>,
}

fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for line in MEASURED.lines().chain(DESIGNED.lines()) {
        if let Some(test) = line.strip_prefix("- ") {
            rows.last_mut().expect("a row begins with its attack").tests.push(test);
        } else {
            let (name, attack) = line.split_once(": ").expect("a name, a colon and the attack");
            assert!(attack.ends_with('.'), "{name} is described by a sentence: {attack}");
            rows.push(Row { name, tests: Vec::new() });
        }
    }
    rows
}

#[test]
fn every_attack_is_named_with_a_test_that_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut known = BTreeSet::new();
    collect(&root.join("tests"), &mut known);
    collect(&root.join("src"), &mut known);
    let mut listed = BTreeSet::new();
    for Row { name, tests } in rows() {
        assert!(listed.insert(name), "{name} is listed twice");
        assert!(!tests.is_empty(), "{name} has no test");
        let mut named = BTreeSet::new();
        for test in tests {
            assert!(named.insert(test), "{name} names {test} twice");
            assert!(known.contains(test), "{name}: there is no test {test}");
        }
    }
}

#[test]
fn only_functions_with_the_attribute_of_a_test_are_found() {
    let text = "#[test]\n#[cfg(unix)]\n// why\nfn a() {}\nfn b() {}\n    #[test]\n    fn c(x in 0..1) {}\nfn d() {}";
    assert_eq!(names(text), ["a", "c"]);
}
